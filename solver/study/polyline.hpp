#pragma once

#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"

/// \file Guesses through waypoints.

namespace extremal {

/// Gives waypoints at free times the times of their guesses, t/T, and a problem without a guess the lines
/// through the points: each coordinate is linear between the points where it is known. `problem.ends` and the
/// duration are set.
void guess_through(std::vector<WaypointCondition>& waypoints, Problem& problem);

}  // namespace extremal
