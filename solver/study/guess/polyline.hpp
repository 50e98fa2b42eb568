#pragma once

#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"

/// \file Guesses through waypoints.

namespace extremal {

/// Gives waypoints at free times the times of their guesses, t/T, and a problem without a guess the lines
/// through the points: each coordinate is linear between the points where it is known. A guess of a closed
/// path may then begin at another time. `problem.ends` and the duration are set.
void guess_through(Extension& extension, Problem& problem);

/// The t/T of waypoints with such times.
std::vector<double> guessed_times(const std::vector<WaypointCondition>& waypoints, double duration);

}  // namespace extremal
