#include "study/model/waypoints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scene/schema.hpp"
#include "study/model/naming.hpp"

namespace extremal {

namespace {

WaypointCondition read_waypoint(const WaypointTable& table, const System& system) {
  WaypointCondition waypoint;
  waypoint.free = table.free;
  if (!table.free) waypoint.time = evaluate_beside(choices_of("waypoints", "at"), table.time, system);
  std::vector<char> fixed(system.names.size());
  for (const Assignment& a : table.values)
    for_each_value(a, range_of(a.name, a.name_at, system, keys_of("waypoints")),
                   [&](int coordinate, const Quantity& value, int index) {
                     if (std::exchange(fixed[coordinate], 1))
                       throw SceneError(a.name_at, fmt::format("'{}' is given by its whole array already",
                                                               system.names[coordinate]));
                     waypoint.fixed.emplace_back(coordinate, evaluate(value, system, index));
                   });
  std::ranges::sort(waypoint.fixed);
  return waypoint;
}

}  // namespace

std::vector<WaypointCondition> read_waypoints(const Scene& scene, const System& system,
                                              const Problem& problem) {
  std::vector<WaypointCondition> waypoints;
  double last = 0;
  for (const WaypointTable& table : scene.waypoints) {
    WaypointCondition& waypoint = waypoints.emplace_back(read_waypoint(table, system));
    if (waypoint.free) {
      if (!problem.lagrangian->structure().autonomous)
        throw SceneError(table.time.at, "at = \"free\" needs a Lagrangian that does not depend on t");
      continue;
    }
    const double duration = problem.duration.value;
    if (!(waypoint.time > 0 && waypoint.time < duration))
      throw SceneError(table.time.at,
                       fmt::format("at = {}; a waypoint lies between 0 and T = {}", waypoint.time, duration));
    if (!(waypoint.time > last))
      throw SceneError(table.time.at, fmt::format("at = {} is not after the waypoint before, at {}; write "
                                                  "waypoints in order of their times",
                                                  waypoint.time, last));
    last = waypoint.time;
  }
  return waypoints;
}

}  // namespace extremal
