#include "solve/converge.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace extremal {

namespace {

/// A factorisation is used again while the simplified steps shrink at least so fast.
constexpr double chord_contraction = 0.2;
/// Corrections below this that shrink no more are amplified roundoff.
constexpr double stagnation = 1e-9;

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
    if (result != StepResult::ok) {
      report.failure = describe(result);
      return report;
    }
    const double rate = std::min(newton.contraction(), 1.0);
    const bool settled = newton.damping() == 1 && rate < 0.5;
    report.remaining = newton.remaining();
    report.most_remaining = newton.most_remaining();
    const bool roundoff = !chord && newton.damping() == 1 && newton.norm() < stagnation && report.steps > 1 &&
                          newton.norm() > 0.3 * before;
    const bool enough = report.remaining <= goal.remaining && report.most_remaining <= goal.most_remaining;
    if (enough || roundoff) {
      report.reached = true;
      return report;
    }
    if (!more) {
      report.failure = "the effort that one solve may take is spent";
      return report;
    }
    chord = settled && rate < chord_contraction;
  }
  report.failure = fmt::format("{} Newton steps did not converge", report.steps);
  return report;
}

}  // namespace extremal
