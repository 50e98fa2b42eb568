#pragma once

#include <string>
#include <vector>

#include "solution/solution.hpp"

/// \file The solution that a result is compared with.

namespace bench {

/// q and q' at ascending times, row by row: q[k*n + a].
struct Reference {
  std::vector<double> t, q, v;
  double range = 0, velocity_range = 0;  ///< largest max − min of a coordinate, of a velocity
  double rounding = 0;                   ///< error of q itself: its numbers are doubles
};

/// A CSV with columns t, each name and each name with a prime.
Reference read_reference(const std::string& path, const std::vector<std::string>& names);

/// Largest difference over coordinates and times; never below what the reference can tell.
struct Difference {
  double q = 0, v = 0;
};

/// Where a free duration came out shorter than the reference's, the motion goes on uniformly.
Difference difference(const extremal::Trajectory& trajectory, const Reference& reference);
/// Samples at the reference's times; what is missing counts as infinitely far.
Difference difference(const std::vector<double>& q, const std::vector<double>& v, const Reference& reference);

}  // namespace bench
