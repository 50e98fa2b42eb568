#include "solve/newton/iteration.hpp"

#include <algorithm>
#include <cmath>

#include "machine/largest.hpp"
#include "solve/newton/agreement.hpp"
#include "solve/newton/ends.hpp"
#include "solve/newton/krylov.hpp"
#include "solve/newton/limits.hpp"
#include "solve/newton/moving_step.hpp"
#include "solve/periodic/soft_shifts.hpp"

namespace extremal {

using namespace limits::iteration;

const ClosingEquation* closing_equation(const Problem& problem, const Path& path, ClosingEquation& equation) {
  const Duration& duration = problem.duration;
  if (!duration.free) return nullptr;
  const std::size_t n = problem.coordinates();
  if (duration.energy) {
    equation.row.clear();
    equation.value = *duration.energy;
  } else {
    equation.row.resize(2 * n);
    equation.value = duration.where({path.node(0), n}, {path.node(path.elements()), n}, equation.row);
  }
  return &equation;
}

void NewtonIteration::reset(const Problem& problem, const ElementTables& tables, int elements,
                            const ElementTables* low) {
  problem_ = &problem;
  tables_ = &tables;
  elements_ = elements;
  const bool sparse = tables.unknowns() > most_dense_unknowns;
  action_.reset(*problem.lagrangian, tables, elements, problem.duration.free,
                sparse ? Condense::nothing : Condense::to_nodes);
  action_.give_momenta(problem.boundary.momenta);
  action_.give_costs(problem.boundary.costs);
  if (tables.kinks() && problem.periodic) {
    closed_ = closing_map(problem);
    action_.close(&closed_);
  }
  norm_ = contraction_ = noise_ = 0;
  damping_ = predicted_ = 1;
  count_ = 0;
  phase_free_ = shifts_held_ = nodes_move_ = false;
  held_ = {};
  if (!sparse) {
    use_dense();
  } else if (low && tables.scheme().degree >= low->scheme().degree && RaisedModel::suits(tables)) {
    use_low(*low, elements);
  } else {
    use_sparse(elements);
  }
}

void NewtonIteration::forget() {
  curvature_ = largest_curvature_ = noise_ = 0;
  extended_ = refined_ = doubling_ = false;
  action_.extend(false);
}

bool NewtonIteration::doubles_digits() const {
  return doubling_ && extended_model_suits(*problem_, *tables_, elements_);
}

bool NewtonIteration::extend() {
  if (refined_ || !dense() || !problem_->boundary.costs.empty()) return false;
  noise_ = 0;
  refined_ = extended_;
  extended_ = true;
  action_.extend(true);
  if (refined_ && doubles_digits()) use_dense();
  return true;
}

/// Elements condensed one by one.
void NewtonIteration::use_dense() {
  const bool doubled = refined_ && doubles_digits();
  std::unique_ptr<SecondVariationModel>& model = doubled ? doubled_ : condensed_;
  if (!model) model = doubled ? make_extended_model() : make_condensed_model();
  use(*model);
  model_->reset(*problem_, *tables_, elements_);
}

/// Whether the factors show that roundoff has taken pivots, though gradients have digits to spare.
bool NewtonIteration::lost_digits() const {
  if (!doubling_ || !extended_ || refined_ || model_ != condensed_.get()) return false;
  const Chain& chain = action_.nodes.chain;
  return chain.pivoted() || !chain.deflated().empty();
}

void NewtonIteration::use_low(const ElementTables& low, int elements) {
  if (!low_) low_.emplace();
  use(*low_);
  low_->reset(*problem_, low, elements);
  if (tables_ == &low) return;
  if (!raised_ || &raised_->low_tables() != &low) raised_.emplace(*low_, low);
  model_ = &*raised_;
  exact_ = nullptr;
  raised_->reset(*problem_, *tables_, elements);
}

void NewtonIteration::use_sparse(int elements) {
  if (!sparse_) sparse_.emplace();
  use(*sparse_);
  sparse_->reset(*problem_, *tables_, elements);
}

/// The correction from the gradient that was evaluated last; NaN if it is not finite. Another correction
/// makes up for steps that are not refined.
double NewtonIteration::solve_for_step(const Path& path, Step& step, bool refine) {
  if (!action_.finite()) return NAN;
  model_->set_refining(refine);
  model_->solve(action_, closing(path), step);
  model_->set_refining(true);
  if (refined_ && action_.extended() && !in_twice_the_precision())
    refine_by_krylov(action_, *model_, path, closing(path), step);
  if (problem_->paired) make_agree(step, problem_->coordinates());
  return length(path, step);
}

/// The largest part of a step, q by the scale; NaN if one is not finite.
double NewtonIteration::length(const Path& path, const Step& step) const {
  const double nodes = largest_if_finite(step.nodes), inner = largest_if_finite(step.inner);
  if (std::isnan(nodes) || std::isnan(inner)) return NAN;
  double size = std::max(nodes, inner) / (scale_ > 0 ? scale_ : 1);
  if (problem_->duration.free) size = std::max(size, std::abs(step.duration) / path.duration());
  return std::isfinite(size) ? size : NAN;
}

bool NewtonIteration::leaves_duration(const Path& path, const Step& step) const {
  return !problem_->duration.free || path.duration() + step.duration > 0;
}

/// `corners` are those of the path before. False if an element would become too short or too long for it.
bool NewtonIteration::apply(Path& path, const Step& step, double factor, std::span<const Corner> corners) {
  if (moves_nodes())
    MovingStep().add(step, factor, path);
  else
    path.add(step.nodes, step.inner, factor);
  keep_ends(problem_->ends, path);
  if (problem_->duration.free) path.set_duration(path.duration() + factor * step.duration);
  path.load_ends();
  return move_corners(path, corners, step.nodes, factor);
}

/// The path as it was saved, and its mesh where that may have moved.
void NewtonIteration::restore(Path& path) {
  if (saved_corners_.empty() && !moves_nodes())
    path.copy_values(saved_);
  else
    path = saved_;
}

bool NewtonIteration::factor_quickly(const Path& path) {
  measure_phases(*problem_, path, tables_->scheme(), !phase_free_, phases_);
  if (shifts_held_) add_soft_shifts(*problem_, path, tables_->scheme(), phases_);
  for (int j = 0; j < held_.count; ++j) phases_.add(held_.direction(j));
  model_->set_phases(phases_.count > 0 ? &phases_ : nullptr);
  return model_->evaluate(action_, path, closing(path)) && action_.finite();
}

/// Inner unknowns are condensed without pivoting; where that breaks down, as at a conjugate time inside one
/// element, all unknowns are factored at once with pivoting, if they are not too many.
bool NewtonIteration::factor(const Path& path) {
  bool done = factor_quickly(path);
  if (action_.finite() && (lost_digits() || (!done && extended_ && doubling_)) && extend())
    done = factor_quickly(path);
  if (done && (pivoted() || action_.nodes.pivot_ratio > breakdown)) return true;
  const bool condensed = model_ == condensed_.get();
  if (!action_.finite() || !(condensed || approximate())) return false;
  if (condensed && path.elements() * std::pow(tables_->unknowns(), 3) > most_pivoted_work) return false;
  use_sparse(path.elements());
  model_->set_phases(phases_.count > 0 ? &phases_ : nullptr);
  return model_->evaluate(action_, path, closing(path));
}

/// Where a short step with good gradients goes astray, its factors do: from the path before it, with better
/// ones, if there are.
bool NewtonIteration::restart_in_twice_the_precision(Path& path) {
  if (refined_ || model_ != condensed_.get() || !doubles_digits()) return false;
  restore(path);
  path.load_ends();
  --count_;
  return extend();
}

StepResult NewtonIteration::full_step(Path& path, double enough, double least_damping) {
  ++count_;
  trials_ = 0;
  if (!factor(path)) return action_.finite() ? StepResult::singular : StepResult::not_finite;
  if (scale_ == 0)
    scale_ = solve_for_step(path, step_);  // a path without extent: its first step is the scale
  const double step = solve_for_step(path, step_);
  if (std::isnan(step)) return StepResult::singular;
  undamped_ = step;
  if (step == 0) {
    norm_ = contraction_ = remaining_ = 0;
    damping_ = 1;
    return StepResult::ok;
  }
  const double expected = approximate() ? 0 : largest_curvature_ * step;
  if (expected > 0 && std::max(worst_surprise * expected, least_curvature * step) * step <= enough &&
      leaves_duration(path, step_))
    return step_without_trial(path, expected);
  if (const std::optional<StepResult> ended = damp(path, step, enough, least_damping)) return *ended;
  if (damping_ == 1 && !approximate()) {
    curvature_ = contraction_ / step;
    if (norm_ > roundoff_step) largest_curvature_ = std::max(largest_curvature_, curvature_);
  }
  predicted_ = std::min(1.0, damping_ * (contraction_ < 0.5 ? 4 : 2));
  remaining_ = norm_;
  if (damping_ == 1 && contraction_ < worth_taking && leaves_duration(path, simplified_)) {
    apply(path, simplified_, 1, action_.corners());
    remaining_ = norm_ * contraction_;
  }
  return StepResult::ok;
}

/// The contraction of earlier steps says that this one is the last: no trial is evaluated.
StepResult NewtonIteration::step_without_trial(Path& path, double expected) {
  contraction_ = surprise * expected;
  norm_ = remaining_ = contraction_ * undamped_;
  damping_ = predicted_ = 1;
  if (std::isnan(solve_for_step(path, step_, true))) return StepResult::singular;
  apply(path, step_, 1, action_.corners());
  return StepResult::ok;
}

/// Natural monotonicity (Deuflhard, Newton Methods for Nonlinear Problems, 3.3): with the step d at x and the
/// simplified step e at x + λd, from the same factors, demand |e| <= (1 − λ/4)|d|. λ is halved until that
/// holds; then nothing is returned. A result ends the step: it stalls, or better factors have begun it anew.
std::optional<StepResult> NewtonIteration::damp(Path& path, double step, double enough,
                                                double least_damping) {
  saved_corners_.assign(action_.corners().begin(), action_.corners().end());
  if (saved_corners_.empty() && !moves_nodes())
    saved_.copy_values(path);
  else
    saved_ = path;
  for (double factor = predicted_; factor >= least_damping; factor /= 2) {
    const bool moved = apply(path, step_, factor, saved_corners_);
    ++trials_;
    const bool positive = moved && path.duration() > 0;
    if (positive) model_->evaluate_gradient(action_, path);
    const double simplified = positive ? solve_for_step(path, simplified_) : NAN;
    const bool monotone = simplified <= (1 - factor / 4) * step;
    if (approximate() && !(simplified <= worst_approximate * step) && !(step < roundoff_step)) {
      restore(path);
      use_sparse(path.elements());
      return full_step(path, enough, least_damping);
    }
    if (!monotone && extended_ && step < limits::converge::stalled_by_factors &&
        restart_in_twice_the_precision(path))
      return full_step(path, enough, least_damping);
    if (positive && (monotone || step < std::max(roundoff_step, quiet * noise_))) {
      contraction_ = simplified / step;
      damping_ = factor;
      norm_ = simplified;
      return std::nullopt;
    }
    restore(path);
  }
  return end_in_noise(path, step);
}

/// No damping is small enough. A step within the noise of its own evaluation is taken as a whole.
StepResult NewtonIteration::end_in_noise(Path& path, double step) {
  path.load_ends();
  if (step < loudest && step <= quiet * measure_noise(path)) {
    apply(path, step_, 1, saved_corners_);
    norm_ = remaining_ = noise_;
    contraction_ = damping_ = predicted_ = 1;
    return StepResult::ok;
  }
  noise_ = 0;
  model_->evaluate_gradient(action_, path);
  return StepResult::stalled;
}

/// Inverse iteration from the step, which has most of that direction already.
bool NewtonIteration::hold_softest(const Path& path) {
  if (model_ != condensed_.get() || problem_->paired) return false;
  held_ = {};
  if (!factor(path) || std::isnan(solve_for_step(path, step_))) return false;
  action_.nodes.gradient = direction_of(step_.nodes, path);
  action_.nodes.border_gradient = action_.nodes.border_part = 0;
  action_.nodes.end_parts.clear();
  ClosingEquation closed;
  if (const ClosingEquation* equation = closing(path)) closed.row = equation->row;
  model_->solve(action_, problem_->duration.free ? &closed : nullptr, step_);
  held_.add(direction_of(step_.nodes, path));
  predicted_ = 1;
  return std::isfinite(largest_if_finite(held_.directions));
}

void NewtonIteration::release() {
  held_ = {};
  predicted_ = 1;
}

StepResult NewtonIteration::chord_step(Path& path) {
  const double before = norm_;
  model_->evaluate_gradient(action_, path);
  ++count_;
  const double norm = solve_for_step(path, step_);
  if (std::isnan(norm) || !leaves_duration(path, step_)) return StepResult::not_finite;
  norm_ = norm;
  contraction_ = before > 0 ? norm_ / before : 0;
  if (norm_ > roundoff_step) largest_curvature_ = std::max(largest_curvature_, contraction_ / undamped_);
  remaining_ = norm_ * std::min(contraction_, 1.0);
  apply(path, step_, 1, action_.corners());
  return StepResult::ok;
}

}  // namespace extremal
