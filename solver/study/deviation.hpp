#pragma once

#include <functional>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file How far two trajectories of one problem are apart.

namespace extremal {

/// q and q' at times, row by row.
struct MotionSamples {
  std::vector<double> q, v;
};

/// A motion that can be sampled at ascending times in [0, duration]; fewer rows come where it breaks off.
struct Motion {
  double duration = 0;
  std::function<MotionSamples(const std::vector<double>& times)> at;
};
Motion motion_of(const Trajectory& trajectory);

/// What changes nothing about a solution: a shift in time, and symmetries.
struct Invariance {
  bool in_time = false;
  std::vector<Generator> symmetries = {};
};
Invariance invariance_of(const Problem& problem);

/// Largest difference of q at equal times of the reference, of the motion moved by what changes nothing so
/// that it is least in the mean; with a shift in time, times that leave a motion are left out. Before and
/// after its own duration a motion goes on uniformly otherwise. Infinite for a motion that breaks off.
double deviation(const Motion& motion, const Motion& reference, int coordinates,
                 const Invariance& invariance = {});

}  // namespace extremal
