#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "solve/branch/events.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/root.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::event_location;

namespace {

/// Mean over τ of the product of two paths, each less its mean, by the nodes.
double swing(const Path& a, const Path& b) {
  const std::size_t n = a.coordinates(), count = a.elements() + 1;
  const std::vector<double> other = interpolated(b.nodes(), n, b.mesh(), a.mesh());
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double product = 0, mean = 0, other_mean = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double weight = 0.5 * (a.mesh()[std::min(k + 1, count - 1)] - a.mesh()[k > 0 ? k - 1 : 0]);
      const double x = a.nodes()[k * n + i], y = other[k * n + i];
      product += weight * x * y;
      mean += weight * x;
      other_mean += weight * y;
    }
    sum += product - mean * other_mean;
  }
  return sum;
}

/// To a value between those before and after: exactly, or, where Newton's method does not land there, nearly.
double find_value(Tracker& tracker, const ProblemFamily& family, const BranchState& from, double value,
                  const Sample& near, const Sample& far) {
  const double distance = std::abs(family.to - family.from), reach = far.at - near.at;
  const auto search = [&](double enough) {
    return root(
        tracker, from, {near.at, near.value - value}, {far.at, far.value - value}, std::nullopt,
        [&] { return tracker.state.varied - value; },
        [&](double off, double change) {
          return std::abs(off) <= std::max(enough * distance, 8 * unit_roundoff * std::abs(value)) ||
                 change <= 2 * unit_roundoff * reach;
        });
  };
  // The number as a parabola, level at a fold: v(σ) = before + slope σ + bend σ².
  const double slope = near.at == 0 ? from.rate : 0, off = value - near.value;
  const double bend = ((far.value - near.value) / reach - slope) / reach;
  const double guess = 2 * off / (slope + std::copysign(std::sqrt(slope * slope + 4 * bend * off), off));
  if (guess >= 0 && guess <= reach && tracker.reach(from, near.at + guess, false, &value) &&
      tracker.turn_is_small()) {
    const double landed = near.at + guess + tracker.landed();
    if (landed >= near.at && landed <= far.at) return landed;
  }
  const double at = search(near_value);
  return std::isfinite(at) && tracker.land(value) ? at : search(at_value);
}

/// Where periodic orbits have all but shrunk to a point: beyond, they would be the same ones half a period
/// later.
double find_rest(Tracker& tracker, const BranchState& from, const BranchState& to, double length) {
  const Problem& problem = tracker.branch().problem();
  if (!problem.periodic || !problem.lagrangian->structure().autonomous) return NAN;
  const double size = swing(from.path, from.path), after = swing(to.path, from.path) / size;
  if (!(after < 0)) return NAN;
  const double at = root(
      tracker, from, {0, 1 - nearly_rest}, {length, after - nearly_rest}, std::nullopt,
      [&] { return swing(tracker.state.path, from.path) / size - nearly_rest; },
      [](double off, double) { return std::abs(off) <= rest_located * nearly_rest; });
  // Orbits that are shifted in time have nothing in common with those before either.
  const Path& path = tracker.state.path;
  return std::isfinite(at) && swing(path, path) <= nearly_rest * size ? at : NAN;
}

/// Mean of |q|² over τ, which a shift in time and a rotation leave as it is.
double mean_square(const Path& path) {
  constexpr int points = 256;
  const Trajectory trajectory = trajectory_of(path);
  std::vector<double> q(path.coordinates()), v(q.size());
  double sum = 0;
  for (int k = 0; k < points; ++k) {
    trajectory.at(trajectory.duration() * (k + 0.5) / points, q, v);
    sum += std::inner_product(q.begin(), q.end(), q.begin(), 0.0);
  }
  return sum / points;
}

/// Whether a state is the first of the branch, passed in the same direction. The action of two copies is
/// zero.
bool is_first(const BranchState& state, const BranchState& first, bool paired) {
  const auto equal = [](double a, double b) {
    return std::abs(a - b) <= limits::event_location::same * std::max(std::abs(a), std::abs(b));
  };
  return state.rate * first.rate > 0 && equal(state.coordinate, first.coordinate) &&
         state.orientation == first.orientation && equal(state.path.duration(), first.path.duration()) &&
         (paired ? equal(mean_square(state.path), mean_square(first.path))
                 : equal(state.action, first.action));
}

/// Along a branch whose members have one value, as shifts in time of an orbit beside which they are none, the
/// first member tells alone where it closes.
double find_first(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const BranchState& first = search.first;
  const double least = located * std::abs(search.family.to - search.family.from);
  for (const BranchState* state : {&step.from, &step.to})
    if (std::abs(state->varied - first.varied) > least) return NAN;
  const double before = tracker.way(first, step.from).along, after = tracker.way(first, step.to).along;
  if (!(before < -limits::event_location::same && after >= 0)) return NAN;
  const double at = root(
      tracker, step.from, {0, before}, {step.length, after}, std::nullopt,
      [&] { return tracker.way(first, BranchState(tracker.state)).along; },
      [](double off, double) { return std::abs(off) <= limits::event_location::same; });
  return std::isfinite(at) && tracker.way(first, BranchState(tracker.state)).length <= first_error ? at : NAN;
}

/// Folds, branch points and period doublings on a step, and the number that varies at its ends and where it
/// turns back.
struct SpecialPoints {
  std::vector<Event> events;
  std::vector<Sample> extremes;
  int index_change = 0;
  bool index_known = true;
  bool leaps = false;  ///< see Crossings
};

SpecialPoints find_special_points(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  SpecialPoints result;
  std::vector<Event> folds = find_folds(tracker, search, step);
  result.extremes.push_back({0, step.from.varied});
  for (const Event& fold : folds) result.extremes.push_back({fold.at, fold.found.point.parameter});
  result.extremes.push_back({step.length, step.to.varied});
  Crossings crossings = find_branch_points(tracker, search, step);
  result.index_change = crossings.change;
  result.index_known = crossings.complete;
  // Where the number turns back, a fold or a branch that crosses is on the step.
  const bool unexplained = turns_back(step) && folds.empty() && crossings.events.empty();
  result.leaps = crossings.leaps || (unexplained && step.length > limits::continuation::shortest_leap);
  // A branch that crosses where this one turns back explains the fold, as the half of a pitchfork does.
  std::erase_if(folds, [&](const Event& fold) {
    return std::ranges::any_of(crossings.events, [&](const Event& crossing) {
      return std::abs(crossing.at - fold.at) <= one * step.length;
    });
  });
  for (std::vector<Event>* events : {&folds, &crossings.events})
    std::ranges::move(*events, std::back_inserter(result.events));
  std::ranges::move(find_doublings(tracker, search, step), std::back_inserter(result.events));
  return result;
}

/// The end of the branch, where it is on a step.
struct End {
  double at = NAN;
  BranchEnd kind = BranchEnd::none;
  std::string message = {};
  std::optional<BranchPoint> last = {};
  bool missed = false;
};

bool passes(const ProblemFamily& family, double value, double a, double b) {
  return (a - value) * (b - value) <= 0 && std::abs(a - value) > located * std::abs(family.to - family.from);
}

/// The value that the branch is to lead to, its first point again, or rest.
End find_end(Tracker& tracker, const EventSearch& search, const BranchStep& step,
             const std::vector<Sample>& extremes) {
  const ProblemFamily& family = search.family;
  bool missed = false;
  const auto find = [&](double value, const auto& wanted) {
    for (std::size_t k = 1; k < extremes.size(); ++k) {
      if (!passes(family, value, extremes[k - 1].value, extremes[k].value)) continue;
      const double at = find_value(tracker, family, step.from, value, extremes[k - 1], extremes[k]);
      if (std::isfinite(at) && wanted()) return at;
      missed = true;
    }
    return double(NAN);
  };
  if (const double at = find(family.to, [] { return true; }); std::isfinite(at))
    return {at, BranchEnd::target, fmt::format("the branch leads to {:.12g}", family.to),
            read_point(tracker, PointKind::regular)};
  if (missed) return {.missed = true};
  const BranchState& state = tracker.state;
  if (const double at =
          find(search.first.varied, [&] { return is_first(state, search.first, family.problem.paired); });
      std::isfinite(at))
    return {at, BranchEnd::closed, "the branch is closed: it came back to its first point"};
  if (const double at = find_first(tracker, search, step); std::isfinite(at))
    return {
        at, BranchEnd::closed,
        fmt::format("the branch is closed: it came back to its first point, and {} is {:.8g} all along it",
                    family.name, state.varied)};
  if (const double at = find_rest(tracker, step.from, step.to, step.length); std::isfinite(at))
    return {at, BranchEnd::rest,
            fmt::format("at {:.8g} the orbits shrink onto an equilibrium, with the period {:.8g}",
                        state.varied, state.path.duration()),
            read_point(tracker, PointKind::regular)};
  return {};
}

}  // namespace

StepEvents locate_events(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const auto& [start, to, length] = step;
  const bool may_end = passes(search.family, search.family.to, start.varied, to.varied) ||
                       passes(search.family, search.first.varied, start.varied, to.varied);
  std::optional<BranchState> aimed;
  if (may_fold(step) || may_double(step) || may_cross(step) || may_end) aimed = tracker.with_cubic(step);
  const BranchStep along{aimed ? *aimed : start, to, length};
  SpecialPoints found = find_special_points(tracker, search, along);
  if (found.leaps) return {.missed = true};
  std::vector<Event>& events = found.events;
  End end = find_end(tracker, search, along, found.extremes);
  if (end.missed) return {.missed = true};
  if (end.kind != BranchEnd::none)
    std::erase_if(events, [&](const Event& event) { return event.at > end.at; });
  if (end.last) events.push_back({end.at, {std::move(*end.last)}});
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at < b.at; });
  StepEvents result{.end = end.kind,
                    .message = std::move(end.message),
                    .index_change = found.index_change,
                    .index_known = found.index_known};
  for (Event& event : events) result.points.push_back(std::move(event.found));
  return result;
}

}  // namespace extremal
