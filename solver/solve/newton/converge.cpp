#include "solve/newton/converge.hpp"
#include "solve/newton/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace extremal {

using namespace limits::converge;

namespace {

constexpr const char* spent = "the limit of work for one solve is reached";

std::string describe(StepResult result) {
  switch (result) {
    case StepResult::singular:
      return "the second variation is singular";
    case StepResult::not_finite:
      return "the action is not finite along the path";
    default:
      return "the steps of Newton's method became too short";
  }
}

/// Whether the last step reached the goal, or roundoff; `before` is the correction before its.
bool arrived(const NewtonIteration& newton, const NewtonGoal& goal, bool chord, double before,
             NewtonReport& report) {
  report.remaining = newton.remaining();
  report.most_remaining = newton.most_remaining();
  const bool roundoff = !chord && newton.damping() == 1 && newton.norm() < amplified_roundoff &&
                        report.steps > 1 && newton.norm() > 0.3 * before;
  const bool enough = report.remaining <= goal.remaining && report.most_remaining <= goal.most_remaining;
  // Or a step stalled at its own roundoff.
  return report.reached = enough || roundoff || newton.noise() > 0;
}

/// Whether another step may use the factors of the last.
bool contracts(const NewtonIteration& newton) {
  return newton.damping() == 1 && newton.contraction() < chord_contraction;
}

/// To the goal, or to roundoff: chord steps as long as they contract.
class ToGoal {
 public:
  ToGoal(NewtonIteration& newton, const Path& path, const ElementTables& tables, const NewtonGoal& goal,
         const std::function<bool()>& on_step)
      : most_steps(goal.steps),
        newton_(newton),
        path_(path),
        tables_(tables),
        goal_(goal),
        on_step_(on_step),
        chord_(goal.reuse) {}

  const int most_steps;
  NewtonReport report;

  Factors factors(int) {
    if (!chord_) newton_.set_scale(scales(path_, tables_).q);
    before_ = newton_.norm();
    return chord_ ? Factors::before : Factors::anew;
  }

  Progress take(StepResult step, int) {
    ++report.steps;
    const bool more = !on_step_ || on_step_();
    if (step == StepResult::stalled && more && newton_.extended() &&
        newton_.undamped() < stalled_by_factors && newton_.extend()) {
      chord_ = false;
      return Progress::more;
    }
    if (step != StepResult::ok) return fail(describe(step));
    if (arrived(newton_, goal_, chord_, before_, report)) return Progress::arrived;
    if (!more) return fail(spent);
    chord_ = contracts(newton_);
    return Progress::more;
  }

  Progress exhausted() { return fail(fmt::format("{} Newton steps did not converge", report.steps)); }

 private:
  Progress fail(std::string reason) {
    report.failure = std::move(reason);
    return Progress::failed;
  }

  NewtonIteration& newton_;
  const Path& path_;
  const ElementTables& tables_;
  const NewtonGoal& goal_;
  const std::function<bool()>& on_step_;
  bool chord_;
  double before_ = 0;  ///< the last correction
};

}  // namespace

NewtonReport converge(NewtonIteration& newton, Path& path, const ElementTables& tables,
                      const NewtonGoal& goal, const std::function<bool()>& on_step) {
  ToGoal policy(newton, path, tables, goal, on_step);
  newton_loop(NewtonSteps{newton, path, goal.remaining}, policy);
  return std::move(policy.report);
}

NewtonReport approach(NewtonIteration& newton, Path& path, const ElementTables& tables,
                      const NewtonGoal& goal, Path& saved, const std::function<bool()>& on_step) {
  if (goal.steps < 2) return converge(newton, path, tables, goal, on_step);
  newton.set_scale(scales(path, tables).q);
  const StepResult first = newton.full_step(path, goal.remaining, mild_damping);
  const bool more = !on_step || on_step();
  NewtonReport report;
  report.steps = 1;
  NewtonGoal rest = goal;
  --rest.steps;
  if (first == StepResult::ok) {
    if (arrived(newton, goal, false, 0, report)) return report;
    rest.reuse = contracts(newton);
  } else if (more && first == StepResult::stalled && newton.hold_softest(path)) {
    saved = path;
    report = converge(newton, path, tables, rest, on_step);
    newton.release();
    report.held = report.reached;
    // Errors of coarse elements are amplified most in the direction that was held; finer ones err less.
    if (report.held) {
      saved = path;
      return report;
    }
    rest.steps -= report.steps;
    path.copy_values(saved);
    path.load_ends();
  }
  if (more && rest.steps > 0) return converge(newton, path, tables, rest, on_step);
  report.failure = spent;
  return report;
}

}  // namespace extremal
