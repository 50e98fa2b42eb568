#pragma once

#include <vector>

#include "rows.hpp"

namespace bench {

/// Arcs of Kepler ellipses, mu = 1, semi-major axis 1, uniform in the eccentricity below 0.9, the true
/// anomaly of the start, and the angle run through (degrees). Guessed by a straight line; or by the angle and
/// the radius linear in t, which runs through the intended angle: then that arc is asked for.
std::vector<Case> kepler_arcs(double least_angle, double most_angle, int count, bool circular);

}  // namespace bench
