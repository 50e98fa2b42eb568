#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>

#include "solution/solution.hpp"
#include "study/study.hpp"

/// \file How far a reference's initial state is from an orbit.

namespace bench {

struct Orbit {
  double period = 0;
  std::function<Eigen::VectorXd(double)> state;  ///< (q, q') at t in [0, period]
};

/// It refers to the solution's trajectory.
Orbit orbit_of(const extremal::Solution& solution);

/// Euclidean distance in (q, q') of the first state of a CSV (columns t, coordinates, velocities) from
/// `orbit`, moved by the symmetries of the problem of `study` so that it is least. Throws
/// extremal::SceneError where the file cannot be read.
double distance_from_orbit(const std::string& csv, const extremal::Study& study, const Orbit& orbit);

}  // namespace bench
