#pragma once

#include <string>

#include "solution/solution.hpp"
#include "study/study.hpp"

/// \file How far a reference's initial state is from an orbit.

namespace bench {

/// Euclidean distance in (q, q') of the first state of a CSV (columns t, coordinates, velocities) from the
/// orbit that `solution` of `study` runs through, moved by the symmetries of the problem so that it is least.
/// Throws extremal::SceneError where the file cannot be read.
double distance_from_orbit(const std::string& csv, const extremal::Study& study,
                           const extremal::Solution& solution);

}  // namespace bench
