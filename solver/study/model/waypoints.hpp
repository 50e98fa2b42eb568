#pragma once

#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file The waypoints of a scene.

namespace extremal {

/// In the order of their times, which lie within the duration of the problem. Throws SceneError.
std::vector<WaypointCondition> read_waypoints(const Scene& scene, const System& system,
                                              const Problem& problem);

}  // namespace extremal
