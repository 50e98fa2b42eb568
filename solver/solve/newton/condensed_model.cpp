#include "solve/newton/model.hpp"
#include "solve/newton/node_system.hpp"

namespace extremal {

namespace {

class CondensedModel final : public SecondVariationModel {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements) override {
    phases_ = nullptr;
    system_.reset(problem.ends, elements, tables.coordinates(), problem.duration.free);
  }

  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override {
    action.evaluate(path);
    negative_ = action.nodes.negative;
    return action.finite() && system_.factor(action.nodes, closing, phases_);
  }

  void evaluate_gradient(DiscreteAction& action, const Path& path) override {
    action.evaluate_gradient(path);
  }

  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override {
    system_.solve(action.nodes, closing, step.nodes, step.duration, refining_);
    action.expand_step(step.nodes, step.duration, step.inner);
  }

  /// Inner unknowns move with the nodes; the part that the gradient adds is left out.
  void respond(DiscreteAction& action, const ClosingEquation* closing, std::span<const double> load,
               Step& step) override {
    NodeEquations& nodes = action.nodes;
    const std::size_t n = action.start_gradient().size();
    nodes.gradient.assign(load.size(), 0);
    for (std::size_t k = n; k + n < load.size(); ++k) nodes.gradient[k] = -load[k];
    nodes.border_gradient = nodes.border_part = 0;
    nodes.end_parts.clear();
    ClosingEquation homogeneous = closing ? *closing : ClosingEquation();
    homogeneous.value = 0;
    system_.solve(nodes, closing ? &homogeneous : nullptr, step.nodes, step.duration);
    action.expand_step(step.nodes, step.duration, step.inner);
    const std::vector<double> rest(step.nodes.size(), 0);
    action.expand_step(rest, 0, left_out_);
    for (std::size_t k = 0; k < step.inner.size(); ++k) step.inner[k] -= left_out_[k];
  }

  void put_load(DiscreteAction& action, const Path& path, const AlignedDoubles& load,
                double on_duration) override {
    action.put_load(path, load, on_duration);
  }

  void set_null_below(double threshold) override { system_.set_null_below(threshold); }

  int left_out() const override { return system_.left_out(); }

  Inertia inertia(double threshold, VariedBy by) override {
    Inertia result = system_.inertia(threshold, by);
    result.negative += negative_;
    return result;
  }

 private:
  NodeSystem system_;
  AlignedDoubles left_out_;
  int negative_ = 0;  ///< among the inner unknowns
};

}  // namespace

void QuadraticModel::add_at_ends(DiscreteAction& action, std::span<const double> parts) {
  std::vector<double>& to = action.nodes.end_parts;
  to.resize(parts.size());
  for (std::size_t e = 0; e < parts.size(); ++e) to[e] += parts[e];
}

std::unique_ptr<SecondVariationModel> make_condensed_model() { return std::make_unique<CondensedModel>(); }

}  // namespace extremal
