#include "solve/iteration.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

/// Below this the damped iteration has stopped to make progress.
constexpr double least_damping = 1e-3;
/// A simplified correction this much smaller than the step is worth taking.
constexpr double worth_taking = 0.3;

double largest(std::span<const double> x) {
  double result = 0;
  for (double value : x) result = std::max(result, std::abs(value));
  return result;
}

}  // namespace

void NewtonIteration::reset(const Problem& problem, const ElementTables& tables, int elements) {
  problem_ = &problem;
  action_.reset(*problem.lagrangian, tables, elements, problem.duration.free);
  system_.reset(problem.ends, elements, problem.coordinates(), problem.duration.free);
  norm_ = contraction_ = 0;
  damping_ = predicted_ = 1;
  count_ = 0;
}

const ClosingEquation* NewtonIteration::closing(const Path& path) {
  const Duration& duration = problem_->duration;
  if (!duration.free) return nullptr;
  const std::size_t n = problem_->coordinates();
  if (duration.energy) {
    closing_.row.clear();
    closing_.value = *duration.energy;
  } else {
    closing_.row.resize(2 * n);
    closing_.value = duration.where({path.node(0), n}, {path.node(path.elements()), n}, closing_.row);
  }
  return &closing_;
}

/// The correction from the gradient that was evaluated last; NaN if it is not finite.
double NewtonIteration::solve_for_step(const Path& path) {
  if (!action_.finite()) return NAN;
  system_.solve(action_.nodes, closing(path));
  action_.expand_step(system_.step(), system_.duration_step(), inner_step_);
  double size = std::max(largest(system_.step()), largest(inner_step_)) / scale_;
  if (problem_->duration.free) size = std::max(size, std::abs(system_.duration_step()) / path.duration());
  return std::isfinite(size) ? size : NAN;
}

void NewtonIteration::apply(Path& path, double factor, bool keep) {
  if (keep) saved_ = path;
  path.add(system_.step(), inner_step_, factor);
  if (problem_->duration.free) path.set_duration(path.duration() + factor * system_.duration_step());
  path.load_ends();
}

/// Natural monotonicity (Deuflhard, Newton Methods for Nonlinear Problems, 3.3): with the step d at x and the
/// simplified step e at x + λd, from the same factors, demand |e| <= (1 − λ/4)|d|.
StepResult NewtonIteration::full_step(Path& path) {
  action_.evaluate(path);
  ++count_;
  if (!action_.finite()) return StepResult::not_finite;
  if (!system_.factor(action_.nodes, closing(path))) return StepResult::singular;
  const double step = solve_for_step(path);
  if (std::isnan(step)) return StepResult::not_finite;
  double factor = predicted_;
  for (;; factor = std::max(factor / 2, 0.1 * factor)) {
    if (factor < least_damping) return StepResult::stalled;
    apply(path, factor, true);
    const bool positive = path.duration() > 0;
    if (positive) action_.evaluate_gradient(path);
    const double simplified = positive ? solve_for_step(path) : NAN;
    if (simplified <= (1 - factor / 4) * step || simplified < 1e-14) {
      contraction_ = simplified / step;
      damping_ = factor;
      norm_ = simplified;
      break;
    }
    path = saved_;
    action_.evaluate_gradient(path);
    solve_for_step(path);  // the step again
  }
  predicted_ = std::min(1.0, damping_ * (contraction_ < 0.5 ? 4 : 2));
  if (damping_ == 1 && contraction_ < worth_taking) apply(path, 1, false);
  return StepResult::ok;
}

StepResult NewtonIteration::chord_step(Path& path) {
  const double before = norm_;
  action_.evaluate_gradient(path);
  ++count_;
  norm_ = solve_for_step(path);
  if (std::isnan(norm_)) return StepResult::not_finite;
  contraction_ = before > 0 ? norm_ / before : 0;
  apply(path, 1, false);
  return StepResult::ok;
}

}  // namespace extremal
