#include <cmath>

#include "solve/newton/extended_system.hpp"
#include "solve/newton/model.hpp"

/// \file The second variation with 106 bits, where the factors of double precision have lost their digits.

namespace extremal {

namespace {

class ExtendedModel final : public SecondVariationModel {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements) override {
    phases_ = nullptr;
    factored_ = false;
    free_duration_ = problem.duration.free;
    lagrangian_ = problem.lagrangian.get();
    tables_ = &tables;
    system_.reset(problem.ends, elements, tables.coordinates(), problem.duration.free);
  }

  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override {
    action.evaluate(path);
    loaded_ = factored_ = false;
    negative_ = action.nodes.negative;
    if (!action.finite()) return false;
    variation_.evaluate(*lagrangian_, *tables_, path, action);
    return factored_ = system_.factor(variation_, action.nodes, closing, phases_);
  }

  /// A model that takes the place of another has no factors from before.
  void evaluate_gradient(DiscreteAction& action, const Path& path) override {
    if (!factored_ && !free_duration_)
      evaluate(action, path, nullptr);
    else
      action.evaluate_gradient(path);
    loaded_ = false;
  }

  /// NaN where there are no factors.
  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override {
    if (!factored_) {
      step.nodes.assign(action.nodes.gradient.size(), NAN);
      return;
    }
    if (action.extended() && !loaded_)
      take_gradient(action);
    else
      take_nodes(action.nodes);
    system_.solve(load_, closing, step);
    action.expand_step(step.nodes, step.duration, step.inner);
  }

  void respond(DiscreteAction& action, const ClosingEquation* closing, std::span<const double> load,
               Step& step) override {
    load_.nodes.reset(load.size(), 1);
    const std::size_t n = action.start_gradient().size();
    for (std::size_t k = n; k + n < load.size(); ++k) load_.nodes.set(k, 0, {-load[k], 0});
    load_.on_duration = 0;
    ClosingEquation homogeneous = closing ? *closing : ClosingEquation();
    homogeneous.value = 0;
    system_.solve(load_, closing ? &homogeneous : nullptr, step);
    action.expand_step(step.nodes, step.duration, step.inner);
    const std::vector<double> rest(step.nodes.size(), 0);
    action.expand_step(rest, 0, left_out_);
    for (std::size_t k = 0; k < step.inner.size(); ++k) step.inner[k] -= left_out_[k];
  }

  void put_load(DiscreteAction& action, const Path& path, const AlignedDoubles& load,
                double on_duration) override {
    action.put_load(path, load, on_duration);
    loaded_ = true;
  }

  Inertia inertia(double threshold, VariedBy by) override {
    Inertia result = system_.inertia(threshold, by);
    result.negative += negative_;
    return result;
  }

 private:
  /// The gradient that was evaluated last, condensed.
  void take_gradient(const DiscreteAction& action) {
    const ExtendedGradient::Values& values = action.extended_gradient();
    const std::size_t n = action.start_gradient().size(), size = values.nodes.size();
    variation_.reduce(values.inner, reduced_);
    load_.nodes.reset(size, 1);
    for (std::size_t k = 0; k < size; ++k)
      load_.nodes.set(k, 0, {values.nodes[k].x[0], values.nodes[k].x[1]});
    for (std::size_t k = 0; k < reduced_.rows(); ++k)
      for (std::size_t a = 0; a < n; ++a) {
        const TwoDoubles by_start = reduced_.at(k, a), by_chord = reduced_.at(k, n + a);
        load_.nodes.add(k * n + a, 0, by_start);
        load_.nodes.add(k * n + a, 0, {-by_chord.high, -by_chord.low});
        load_.nodes.add((k + 1) * n + a, 0, by_chord);
      }
    const std::span<const double> momenta = action.momenta();
    for (std::size_t e = 0; e < momenta.size(); ++e)
      load_.nodes.add(e < n ? e : size - 2 * n + e, 0, {e < n ? momenta[e] : -momenta[e], 0});
    load_.on_duration = action.nodes.border_part + action.nodes.border_gradient;
  }

  /// A gradient in double precision, as the action condensed it.
  void take_nodes(const NodeEquations& nodes) {
    const std::size_t size = nodes.gradient.size(), n = nodes.end_parts.size() / 2;
    load_.nodes.reset(size, 1);
    for (std::size_t k = 0; k < size; ++k) load_.nodes.set(k, 0, {nodes.gradient[k], 0});
    for (std::size_t e = 0; e < nodes.end_parts.size(); ++e)
      load_.nodes.add(e < n ? e : size - 2 * n + e, 0, {nodes.end_parts[e], 0});
    load_.on_duration = nodes.border_part + nodes.border_gradient;
  }

  const Lagrangian* lagrangian_ = nullptr;
  const ElementTables* tables_ = nullptr;
  ExtendedVariation variation_;
  ExtendedSystem system_;
  ExtendedSystem::Load load_;
  ExtendedRows reduced_;
  AlignedDoubles left_out_;
  bool loaded_ = false, factored_ = false, free_duration_ = false;
  int negative_ = 0;  ///< among the inner unknowns
};

}  // namespace

std::unique_ptr<SecondVariationModel> make_extended_model() { return std::make_unique<ExtendedModel>(); }

bool extended_model_suits(const Problem& problem, const ElementTables& tables, int elements) {
  return elements >= 2 && !problem.paired && !tables.kinks() && problem.boundary.costs.empty() &&
         ExtendedVariation::suits(*problem.lagrangian, tables.scheme());
}

}  // namespace extremal
