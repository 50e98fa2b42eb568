#include "solve/branch/branch_point.hpp"
#include "solve/branch/limits.hpp"
#include "solve/periodic/doubled_orbit.hpp"

/// \file Where branches begin, as it is found on the branch that they leave.

namespace extremal {

using namespace limits::branch_points;

namespace {

BranchStart::Place place_of(const BranchState& state) {
  return {state.path, state.coordinate, state.varied, state.action};
}

/// The orbit run through twice.
void double_place(Tracker& tracker, bool by_duration, BranchStart::Place& place) {
  const Path once = place.path;
  double_path(tracker.branch().problem(), once, tracker.branch().tables(), place.path);
  place.action *= 2;
  if (by_duration) place.coordinate *= 2;
}

}  // namespace

std::optional<BranchStart> branch_start(Tracker& tracker, const EventSearch& search, PointKind kind,
                                        const BranchState& from, double at, int count) {
  if (!search.starts) return std::nullopt;
  BranchState base = from;
  if (kind == PointKind::period_doubling) {  // on elements that are its own
    if (!tracker.reach(from, at)) return std::nullopt;
    base = tracker.state;
    at = 0;
  }
  const BranchStart::Place place = place_of(tracker.state);
  if (!tracker.reach(base, at - start_distance, true) && !tracker.reach(base, at + start_distance, true))
    return std::nullopt;
  BranchStart start{
      kind, place, place_of(tracker.state), tracker.state.units, count, tracker.branch().regular()};
  if (kind == PointKind::branch) return start;
  const bool by_duration = search.family.varied != Varied::parameter;
  double_place(tracker, by_duration, start.at);
  double_place(tracker, by_duration, start.beside);
  if (search.family.varied == Varied::duration) start.at.varied *= 2;
  start.units.duration *= 2;
  return start;
}

}  // namespace extremal
