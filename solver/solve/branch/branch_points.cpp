#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/branch_point.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/root.hpp"
#include "solve/periodic/doubled_orbit.hpp"

/// \file Points of a step where other branches cross.

namespace extremal {

using namespace limits::branch_points;

namespace {

/// One end of the interval that holds a branch point.
struct Side {
  double at = 0, weight = 1;
  Move response = {};
  double size = 0;  ///< of the response; 0: not known
};

/// The branch point, or, where the equations are too singular there, a point next to it: the number that
/// varies is then interpolated by the cubic through points on either side.
std::optional<BranchPoint> branch_point_at(Tracker& tracker, const BranchState& from, double at,
                                           double length) {
  if (tracker.reach_smoothly(from, at)) return read_point(tracker, PointKind::branch);
  for (const double share : offsets) {
    const double off = share * length;
    if (!tracker.reach_smoothly(from, at + off)) continue;
    const BranchState after = tracker.state;
    if (!tracker.reach_smoothly(from, at - off) || !branches_cross(tracker.state, after)) continue;
    BranchPoint point = read_point(tracker, PointKind::branch);
    const BranchState& before = tracker.state;
    point.parameter = 0.5 * (before.varied + after.varied) - 0.25 * off * (after.rate - before.rate);
    return point;
  }
  return std::nullopt;
}

/// To a state at `guess`, or aside of it where the equations are too singular. NaN if there is none.
double state_near(Tracker& tracker, const BranchState& from, double guess, double aside,
                  const Side (&sides)[2]) {
  for (const double at :
       {guess, guess + aside * (sides[1].at - guess), guess - aside * (guess - sides[0].at)})
    if (tracker.reach_smoothly(from, at, true)) return at;
  return NAN;
}

/// By halves where the orientation changes, then by the secant of ±1/|response|, which passes zero at a
/// branch point.
double narrow(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
              const BranchState& before, Side (&sides)[2]) {
  const Branch& branch = tracker.branch();
  Move response;
  double last = sides[0].at, best = NAN;
  bool lower_before = false, balanced = false;
  std::optional<double> aside_of;
  for (int k = 0; k < most_trials; ++k) {
    const bool known = sides[0].size > 0 && sides[1].size > 0;
    const bool near =
        known && branch.dot(sides[0].response, sides[1].response) < opposite * sides[0].size * sides[1].size;
    const double a = near ? sides[0].weight / sides[0].size : 1,
                 b = near ? sides[1].weight / sides[1].size : 1;
    const double secant = (sides[0].at * b + sides[1].at * a) / (a + b);
    const double guess = aside_of ? *std::exchange(aside_of, std::nullopt) : secant;
    if (near) best = secant;
    const double at = state_near(tracker, from, guess, near ? aside_near : aside_far, sides);
    if (std::isnan(at)) return best;
    tracker.branch().respond(tracker.state.tangent, response);
    const double size = std::sqrt(branch.dot(response, response));
    const bool lower =
        near ? branch.dot(response, sides[0].response) > 0 : !branches_cross(tracker.state, before);
    // At the branch point itself the way along the other branch may count as null and be left out. The secant
    // between points as far on either side shows where that is.
    const bool gone = near && size < std::min(sides[0].size, sides[1].size);
    if (gone && !balanced) {
      balanced = true;
      const Side& nearer = at - sides[0].at < sides[1].at - at ? sides[0] : sides[1];
      aside_of = 2 * at - nearer.at;
      continue;
    }
    // Without a response that grows the index was miscounted, as it may be where elements are very unequal;
    // where both sides were known, roundoff hides all that is nearer.
    if (!std::isfinite(size) || size == 0 || gone || is_located(tracker, family, at - last) || at == last)
      return near ? at : best;
    last = at;
    // The same side again: the other one counts less (Illinois).
    if (near && lower == lower_before) sides[lower ? 1 : 0].weight *= 0.5;
    sides[lower ? 0 : 1] = {at, 1, response, size};
    lower_before = lower;
  }
  return NAN;
}

/// Between low, where the branch is as `before`, and high. `response` becomes that next to the branch point:
/// at it, there may be none. NaN where the branch cannot be followed.
double find_branch_point(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
                         const BranchState& before, double low, double high, Move& response) {
  Side sides[2] = {{.at = low}, {.at = high}};
  const double at = narrow(tracker, family, from, before, sides);
  response = std::move(sides[sides[0].size > sides[1].size ? 0 : 1].response);
  return response.step.nodes.empty() ? NAN : at;
}

}  // namespace

bool branches_cross(const BranchState& a, const BranchState& b) {
  return a.orientation != b.orientation || std::abs(a.index - b.index) >= 2;
}

std::vector<Event> find_branch_points(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const auto& [from, to, length] = step;
  std::vector<Event> found;
  BranchState before = from;
  double low = 0;
  for (int k = 0; k < most_points && branches_cross(before, to); ++k) {
    Move response;
    const double at = find_branch_point(tracker, search.family, from, before, low, length, response);
    if (!std::isfinite(at)) return found;
    BranchState base = from;
    double there = at;
    if (auto finer = tracker.resolved_for(from, response)) {
      const bool begins = tracker.reach(*finer, low, true) && !branches_cross(tracker.state, before);
      const double again = begins ? find_branch_point(tracker, search.family, *finer,
                                                      BranchState(tracker.state), low, length, response)
                                  : NAN;
      if (begins && !std::isfinite(again)) return found;  // on those elements alone
      if (begins) {
        base = *std::move(finer);
        there = again;
      }
    }
    std::optional<BranchPoint> point = branch_point_at(tracker, base, there, length);
    if (!point) return found;
    found.push_back({at, {*std::move(point), branch_start(tracker, search, PointKind::branch, base, there)}});
    low = at + beyond_it * length;
    if (!(low < length) || !tracker.reach(from, low, true)) return found;
    before = tracker.state;
  }
  return found;
}

std::optional<BranchStart> branch_start(Tracker& tracker, const EventSearch& search, PointKind kind,
                                        const BranchState& from, double at) {
  if (!search.starts) return std::nullopt;
  if (!tracker.reach(from, at - start_distance) && !tracker.reach(from, at + start_distance))
    return std::nullopt;
  const BranchState& state = tracker.state;
  BranchStart start{kind, state.path, state.coordinate, state.units};
  if (kind == PointKind::branch) return start;
  double_path(tracker.branch().problem(), state.path, tracker.branch().tables(), start.path);
  start.units.duration *= 2;
  if (search.family.varied != Varied::parameter) start.coordinate *= 2;
  return start;
}

}  // namespace extremal
