#pragma once

#include <random>
#include <vector>

#include "problem/problem.hpp"

/// \file Points to try a Lagrangian at.

namespace extremal {

/// Points about the guess, or about the line between the ends, with velocities of any direction; the same
/// at every call, whatever the standard library.
class NearbyPoints {
 public:
  /// Keeps a reference to the problem.
  explicit NearbyPoints(const Problem& problem);

  /// The next point: q and q' with n entries each; returns t.
  double next(std::vector<double>& q, std::vector<double>& v);

 private:
  double uniform();  ///< in (-1, 1)

  const Problem& problem_;
  int n_;
  std::vector<double> scale_;  ///< of each coordinate: its largest value, or 1
  std::mt19937_64 random_{20240229};
};

}  // namespace extremal
