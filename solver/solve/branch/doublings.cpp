#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "solve/branch/branch_point.hpp"
#include "solve/branch/root.hpp"
#include "solve/periodic/stability.hpp"

/// \file Points of a step where orbits of twice the period begin.

namespace extremal {

namespace {

double product(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 1.0, std::multiplies());
}

/// Where on a step test k may pass zero twice: it keeps its sign, and would not if it continued as before,
/// but bends away from zero. Where the parabola through its last three values is level.
std::optional<double> level_point(const BranchStep& step, std::size_t k) {
  const auto& [from, to, length] = step;
  if (from.doubling_tests_before.size() != from.doubling_tests.size()) return std::nullopt;
  const double test = from.doubling_tests[k], change = to.doubling_tests[k] - test;
  const double before = (test - from.doubling_tests_before[k]) / from.back;
  if (!(test * to.doubling_tests[k] > 0 && test * (test + before * length) <= 0)) return std::nullopt;
  const double bend = (change / length - before) / (length + from.back);
  const double level = 0.5 * (length - change / (length * bend));
  return std::clamp(level, 0.1 * length, 0.9 * length);
}

}  // namespace

std::vector<double> read_doubling_tests(Tracker& tracker) {
  const Problem& problem = tracker.branch().problem();
  const Trajectory trajectory = trajectory_of(tracker.state.path);
  SecondVariation& variation = tracker.workspace().variation;
  if (!variation.assemble(problem.lagrangian, trajectory, tracker.condensed(), nullptr,
                          problem.paired ? Definite::paired : Definite::positive))
    return {NAN};
  const std::optional<Floquet> found =
      multipliers_of(problem, variation, closed_orbit(problem, trajectory, 0));
  return found ? doubling_tests(*found) : std::vector<double>{NAN};
}

bool may_double(const BranchStep& step) {
  const std::vector<double>&from = step.from.doubling_tests, &to = step.to.doubling_tests;
  if (from.size() != to.size()) return changes_sign(product(from), product(to));
  for (std::size_t k = 0; k < from.size(); ++k)
    if (changes_sign(from[k], to[k]) || level_point(step, k)) return true;
  return false;
}

/// Test by test, in their order; all together where pairs of multipliers have met or parted.
std::vector<Event> find_doublings(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const auto& from = step.from;
  const auto& to = step.to;
  const bool same = from.doubling_tests.size() == to.doubling_tests.size();
  const std::size_t count = same ? from.doubling_tests.size() : 1;
  std::vector<Event> found;
  for (std::size_t k = 0; k < count; ++k) {
    const auto of = [&](const std::vector<double>& tests) {
      return same && tests.size() == count ? tests[k] : product(tests);
    };
    const auto test = [&] { return of(read_doubling_tests(tracker)); };
    std::vector<Sample> samples = {{0, of(from.doubling_tests)}, {step.length, of(to.doubling_tests)}};
    if (const auto level = same ? level_point(step, k) : std::nullopt)
      if (const auto between = dip(tracker, from, samples[0], samples[1], *level, test))
        samples.insert(samples.begin() + 1, *between);
    std::optional<Sample> before;
    if (from.back > 0) before = {-from.back, of(from.doubling_tests_before)};
    find_roots(tracker, search.family, from, samples, before, test, [&](double at) {
      BranchPoint point = read_point(tracker, PointKind::period_doubling);
      found.push_back(
          {at, {std::move(point), branch_start(tracker, search, PointKind::period_doubling, from, at)}});
    });
  }
  return found;
}

}  // namespace extremal
