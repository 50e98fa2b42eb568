#pragma once

#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"

/// \file Times of waypoints by a guess.

namespace extremal {

/// Where free, the times at which the guess is nearest, in order.
void time_by_guess(std::vector<WaypointCondition>& waypoints, const Problem& problem);

/// Likewise on a closed path on which any time may be the first one. The guess is made to begin in the middle
/// between the last waypoint and the first.
void begin_between(std::vector<WaypointCondition>& waypoints, Problem& problem);

}  // namespace extremal
