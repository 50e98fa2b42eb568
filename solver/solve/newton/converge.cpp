#include "solve/newton/converge.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace extremal {

namespace {

/// A factorisation is used again while the simplified steps shrink at least so fast.
constexpr double chord_contraction = 0.2;
/// A first step that needs more is not trusted.
constexpr double mild_damping = 0.25;
/// Steps this short that stall, though gradients have digits to spare, are told by factors that have none.
constexpr double stalled_by_factors = 1e-5;

constexpr const char* spent = "the effort that one solve may take is spent";

std::string describe(StepResult result) {
  switch (result) {
    case StepResult::singular:
      return "the second variation became singular";
    case StepResult::not_finite:
      return "the action is not finite along the path";
    default:
      return "Newton's method had to be damped too strongly";
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

}  // namespace

NewtonReport converge(NewtonIteration& newton, Path& path, const ElementTables& tables,
                      const NewtonGoal& goal, const std::function<bool()>& on_step) {
  NewtonReport report;
  bool chord = goal.reuse;
  while (report.steps < goal.steps) {
    if (!chord) newton.set_scale(scales(path, tables).q);
    const double before = newton.norm();
    const StepResult result = chord ? newton.chord_step(path) : newton.full_step(path, goal.remaining);
    ++report.steps;
    const bool more = !on_step || on_step();
    if (result == StepResult::stalled && more && newton.extended() &&
        newton.undamped() < stalled_by_factors && newton.extend()) {
      chord = false;
      continue;
    }
    if (result != StepResult::ok) {
      report.failure = describe(result);
      return report;
    }
    if (arrived(newton, goal, chord, before, report)) return report;
    if (!more) {
      report.failure = spent;
      return report;
    }
    chord = contracts(newton);
  }
  report.failure = fmt::format("{} Newton steps did not converge", report.steps);
  return report;
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
    // Errors of coarse elements are amplified most in the direction that was held; finer ones tell it.
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
