#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "solution/solution.hpp"
#include "system/lagrangian.hpp"

/// \file How far two motions from the same initial data are apart.

namespace extremal {

/// Largest differences over all coordinates, and the largest ranges of the better motion.
struct MotionDeviation {
  struct Sizes {
    double q = 0, v = 0, p = 0;
  };
  Sizes error, range;
  double magnitude = 0;         ///< largest |q|
  double largest_momentum = 0;  ///< largest |p|
  double duration = 0;
  bool finite = true;

  /// An error of q, q' or p, and what the tolerance allows: that times the range, ten times that for q' and
  /// p.
  struct Part {
    const char* of;
    double error, allowed;
    double excess() const { return error == 0 ? 0 : error / allowed; }
  };
  /// The one that is largest beside what is allowed.
  Part worst(double tolerance) const;
  double excess(double tolerance) const;
  /// The first time at which it is above 1; infinite if it never is.
  double exceeded(double tolerance) const;

  /// Where an error had grown by a tenth since the last entry.
  struct Growth {
    double time;
    Sizes error;
  };
  std::vector<Growth> growth;
};

/// Compares at points inside the elements of `better` and, where elements of `motion` are shorter, in the
/// middle of some of these. Both have the same duration, and slopes at their nodes.
MotionDeviation deviation(const Lagrangian& lagrangian, const Trajectory& motion, const Trajectory& better);

}  // namespace extremal
