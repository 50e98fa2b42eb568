#include <algorithm>
#include <cmath>

#include "solve/branch/branch_point.hpp"
#include "solve/branch/root.hpp"

/// \file Points of a step where the number that varies turns back.

namespace extremal {

namespace {

/// Of a step: so far from a fold its sides are told apart.
constexpr double beside_it = 1e-4;

/// Of the derivative of the number that varies, as the parabola has it whose values at both ends of the step
/// and whose integral are known: its extremum between, and its value in the middle.
struct Rates {
  Sample extremum, middle;
};

Rates rates_on(const BranchStep& step) {
  const auto& [from, to, length] = step;
  const double first = from.rate, last = to.rate * to.back / length;
  const double mean = (to.varied - from.varied) / length;
  const double slope = 6 * mean - 4 * first - 2 * last, bend = 3 * (first + last - 2 * mean);
  const double at = -slope / (2 * bend);
  const bool between = at > 0 && at < 1;
  return {between ? Sample{at * length, first + 0.5 * slope * at} : Sample{0, first},
          {0.5 * length, first + 0.5 * slope + 0.25 * bend}};
}

/// Of a step, the derivative of the number at both ends.
std::vector<Sample> ends_of(const BranchStep& step) {
  return {{0, step.from.rate}, {step.length, step.to.rate * step.to.back / step.length}};
}

/// Whether the number turns back between two samples of its derivative. |∂varied/∂s| times the distance from
/// a fold bounds the error of the number there: a smaller extremum than that is none. Between samples r and s
/// at the distance ℓ the number rises above its chord by |r − s|ℓ/8.
enum class Turn { none, hidden, known };
Turn turn_between(const BranchStep& step, const Sample& a, const Sample& b) {
  if (!changes_sign(a.value, b.value)) return Turn::none;
  const double error = std::max(step.from.varied_error, step.to.varied_error);
  return std::abs(b.value - a.value) * (b.at - a.at) / 8 <= error ? Turn::hidden : Turn::known;
}

}  // namespace

bool turns_back(const BranchStep& step) {
  const std::vector<Sample> ends = ends_of(step);
  return turn_between(step, ends[0], ends[1]) == Turn::known;
}

bool may_fold(const BranchStep& step) {
  const double first = step.from.rate;
  return first * step.to.rate < 0 || first * rates_on(step).extremum.value < 0;
}

std::vector<Event> find_folds(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const BranchState &from = step.from, &to = step.to;
  const double length = step.length;
  std::vector<Sample> samples = ends_of(step);
  const auto rate = [&] { return tracker.state.rate; };
  const auto [extremum, middle] = rates_on(step);
  if (from.rate * to.rate > 0 && from.rate * extremum.value < 0) {
    std::size_t left = most_samples;
    resolve_doubts(samples, {{0, extremum.at, length}}, least_interval * length, [&](double at) {
      return left > 0 && left-- && tracker.reach_smoothly(from, at) ? rate() : NAN;
    });
  }
  for (std::size_t k = 1; k < samples.size(); ++k)
    if (turn_between(step, samples[k - 1], samples[k]) == Turn::hidden) return {};
  std::vector<Event> found;
  find_roots(tracker, search.family, from, samples, middle, rate, [&](double at) {
    found.push_back({at, {read_point(tracker, PointKind::fold)}});
    Solution& solution = found.back().found.point.solution;
    if (!tracker.reach(from, at - beside_it * length)) return;
    const BranchState before = tracker.state;
    if (tracker.reach(from, at + beside_it * length)) count_null_directions(solution, before, tracker.state);
  });
  return found;
}

}  // namespace extremal
