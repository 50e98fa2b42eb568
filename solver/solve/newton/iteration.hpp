#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "action/discrete_action.hpp"
#include "action/path.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/newton/newton_loop.hpp"
#include "solve/newton/raised_model.hpp"

/// \file Newton's method for δS_h = 0 on one discretisation: full steps damped by natural monotonicity,
/// and chord steps that reuse a factorisation.

namespace extremal {

/// The equation that closes the duration of a problem, at the path's ends, in the memory of `equation`; null
/// where the duration is fixed.
const ClosingEquation* closing_equation(const Problem& problem, const Path& path, ClosingEquation& equation);

/// How a step ended.
enum class StepResult {
  ok,
  singular,    ///< the second variation is singular to working precision
  not_finite,  ///< the action, or a step, is not finite
  stalled,     ///< damping became too strong
};

/// Works on a path in place. Norms of steps are relative: largest change of q by `scale`, or of T by T.
class NewtonIteration {
 public:
  /// Binds to a problem and one discretisation; memory is kept. Where the Hessian would be a large sparse
  /// matrix and `low` tables of a lower degree are given, steps come from factors of those (RaisedModel) as
  /// long as they contract; model() is then no more than a model.
  void reset(const Problem& problem, const ElementTables& tables, int elements,
             const ElementTables* low = nullptr);
  void set_scale(double scale) { scale_ = scale; }
  /// From now on steps end without a result when the deadline passes: as singular, or not finite.
  void end_at(const Deadline& deadline) { action_.end_at(deadline); }

  /// Assembles at `path`, factors and takes a damped step; then, where the simplified step that tested it
  /// is much smaller, takes that as well. `norm` becomes the size of the last correction, `contraction` its
  /// ratio to the one before. A step so short that earlier contraction lets expect the next correction
  /// below `enough` is not tested: `norm` is then the expected size. Stronger damping than `least_damping` is
  /// a stall: the path is then where it was.
  static constexpr double strongest_damping = 1e-3;
  StepResult full_step(Path& path, double enough, double least_damping = strongest_damping);

  /// Forgets the curvature of δS: the path is another.
  void forget();
  /// From now until forget() factors may have 106 bits, where the system allows that and doubles lose digits.
  void double_digits() { doubling_ = true; }
  /// From now until forget() gradients are in extended precision, where the system has them; from the second
  /// time on so is the second variation that steps are solved for, with its factors where they may be. False
  /// if they were, or where the Hessian is a large sparse matrix.
  bool extend();
  bool extended() const { return extended_; }
  /// Whether factors have 106 bits.
  bool in_twice_the_precision() const { return doubled_ && model_ == doubled_.get(); }
  /// Roundoff of a step, where one stalled at it: no path is nearer to an extremal than this. 0 elsewhere.
  double noise() const { return noise_; }
  /// Roundoff of a step from `path`, with the factors there are: no step measures a smaller
  /// distance from an extremal.
  double roundoff(Path& path);

  /// From now until release() steps leave out the direction in which the path last factored is softest. False
  /// where that cannot be done.
  bool hold_softest(const Path& path);
  /// The same with given directions, as PhaseConditions has them; until release() or reset().
  void hold(PhaseConditions directions) { held_ = std::move(directions); }
  void release();

  /// Assembles at `path` and factors, without a step; false if that is singular to working precision.
  bool factor(const Path& path);
  /// The same, but gives up where pivoting would be needed.
  bool factor_quickly(const Path& path);

  /// Whether steps may shift a periodic path in time (by default not): elements prefer some phases, by no
  /// more than they err. Forgotten by reset().
  void free_phase(bool free) { phase_free_ = free; }

  /// Whether steps may shift parts of a path between times of rest (by default they may), see
  /// add_soft_shifts(). Forgotten by reset().
  void hold_shifts(bool on) { shifts_held_ = on; }
  /// How many shifts the factors hold.
  int held_shifts() const { return shifts_held_ ? phases_.count : 0; }

  /// Whether steps move the nodes in time with the path, see MovingStep (by default only those in twice the
  /// precision do). Forgotten by reset().
  void move_nodes(bool on) { nodes_move_ = on; }

  /// One more correction with the factors there are.
  StepResult chord_step(Path& path);
  /// The length of that correction with the gradient of another quadrature on the same elements, and of
  /// its roundoff. action() then has that gradient. Of inner steps, laid out as Path::x, the part
  /// `explained` does not count.
  double step_under(const ElementTables& quadrature, const Path& path, const AlignedDoubles& explained = {});

  /// Of the velocities that such a step changes, the mean over an element, the most, without the part that
  /// the last digits of t make where they change fast.
  double steepness(const Path& path) const;

  /// The error to be expected after a full step of this length and the simplified one, from the last that
  /// was tested.
  double expected(double step) const { return curvature_ * curvature_ * step * step * step; }

  double norm() const { return norm_; }
  /// Expected size of the correction after it.
  double remaining() const { return remaining_; }
  /// The same if the remainder points to where the equations bend most, not along the last step.
  double most_remaining() const {
    return std::max(remaining_, norm_ * std::min(1.0, largest_curvature_ * undamped_));
  }
  double contraction() const { return contraction_; }
  double damping() const { return damping_; }
  int count() const { return count_; }
  /// The undamped step of the last full_step.
  double undamped() const { return undamped_; }

  DiscreteAction& action() { return action_; }
  const DiscreteAction& action() const { return action_; }
  /// The same where elements are condensed one by one; else null.
  const DiscreteAction* condensed() const { return model_ == condensed_.get() ? &action_ : nullptr; }
  /// The second variation that was factored last.
  QuadraticModel& model() { return *model_; }
  /// The same; null where steps come from factors of a lower degree.
  SecondVariationModel* second_variation() { return exact_; }
  /// The largest component of δS under the boundary relation, where the action was evaluated last.
  double residual() const;
  /// The same at `path`.
  double residual_at(const Path& path);
  /// How many times longer than without pivoting a step takes, roughly.
  double burden() const;
  /// Largest second derivative of S_h by q(0).
  double stiffness() const;
  /// The equation that closes the duration, at the path's ends; null where it is fixed.
  const ClosingEquation* closing(const Path& path) { return closing_equation(*problem_, path, closing_); }

 private:
  void use(SecondVariationModel& model) { model_ = exact_ = &model; }
  void use_low(const ElementTables& low, int elements);
  void use_sparse(int elements);
  void use_dense();
  /// Whether all unknowns are factored at once, with pivoting.
  bool pivoted() const { return sparse_ && model_ == &*sparse_; }
  bool dense() const { return model_ == condensed_.get() || in_twice_the_precision(); }
  bool moves_nodes() const { return nodes_move_ || in_twice_the_precision(); }
  bool doubles_digits() const;
  bool lost_digits() const;
  bool restart_in_twice_the_precision(Path& path);
  StepResult step_without_trial(Path& path, double expected);
  std::optional<StepResult> damp(Path& path, double step, double enough, double least_damping);
  StepResult end_in_noise(Path& path, double step);
  /// Whether model() is not the second variation itself.
  bool approximate() const { return exact_ == nullptr; }
  double solve_for_step(const Path& path, Step& step, bool refine = false);
  double length(const Path& path, const Step& step) const;
  /// Whether the whole step leaves a positive duration.
  bool leaves_duration(const Path& path, const Step& step) const;
  bool apply(Path& path, const Step& step, double factor, std::span<const Corner> corners);
  void restore(Path& path);
  double measure_noise(Path& path);
  bool round_equations(const Path& path);
  double terms_at_end(const Path& path, std::size_t e) const;

  const Problem* problem_ = nullptr;
  const ElementTables* tables_ = nullptr;
  DiscreteAction action_;
  std::unique_ptr<SecondVariationModel> condensed_, doubled_;  ///< the second with 106 bits
  std::optional<SparseModel> sparse_, low_;
  std::optional<RaisedModel> raised_;
  QuadraticModel* model_ = nullptr;
  SecondVariationModel* exact_ = nullptr;  ///< the same, or null
  Step step_, simplified_;
  ClosingEquation closing_;
  PhaseConditions phases_;
  bool phase_free_ = false, shifts_held_ = false, nodes_move_ = false, extended_ = false, refined_ = false,
       doubling_ = false;
  PhaseConditions held_;
  Path saved_;
  ClosingMap closed_;  ///< of a periodic problem with kinks
  std::vector<Corner> saved_corners_;
  mutable std::vector<double> free_;
  double scale_ = 1, norm_ = 0, remaining_ = 0, undamped_ = 0, contraction_ = 0, damping_ = 1, predicted_ = 1;
  double noise_ = 0;
  double curvature_ = 0;  ///< contraction of the last full step by its length; 0: not known
  double largest_curvature_ = 0;
  int count_ = 0, elements_ = 0;
  int trials_ = 0;  ///< dampings that the last full step tried
};

/// δS_h = 0 on one discretisation, for newton_loop(): steps are tested, and taken, by the iteration itself.
struct NewtonSteps {
  NewtonIteration& newton;
  Path& path;
  double enough = 0;  ///< see full_step()

  StepResult operator()(Factors factors) {
    return factors == Factors::anew ? newton.full_step(path, enough) : newton.chord_step(path);
  }
};

}  // namespace extremal
