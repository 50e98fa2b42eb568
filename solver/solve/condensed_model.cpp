#include "solve/model.hpp"
#include "solve/node_system.hpp"

namespace extremal {

namespace {

class CondensedModel final : public QuadraticModel {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements) override {
    system_.reset(problem.ends, elements, tables.coordinates(), problem.duration.free);
  }

  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override {
    action.evaluate(path);
    negative_ = action.nodes.negative;
    return action.finite() && system_.factor(action.nodes, closing);
  }

  void evaluate_gradient(DiscreteAction& action, const Path& path) override {
    action.evaluate_gradient(path);
  }

  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override {
    system_.solve(action.nodes, closing, step.nodes, step.duration, refining_);
    action.expand_step(step.nodes, step.duration, step.inner);
  }

  Inertia inertia(double threshold) override {
    Inertia result = system_.inertia(threshold);
    result.negative += negative_;
    return result;
  }

 private:
  NodeSystem system_;
  int negative_ = 0;  ///< among the inner unknowns
};

}  // namespace

std::unique_ptr<QuadraticModel> make_condensed_model() { return std::make_unique<CondensedModel>(); }

}  // namespace extremal
