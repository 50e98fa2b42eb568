#pragma once

#include <vector>

#include "report/plot.hpp"
#include "report/result.hpp"
#include "study/study.hpp"

/// \file Trajectories at the times that reports need.

namespace extremal {

/// `count` equal steps' ends, from 0 to the duration.
std::vector<double> equal_times(int count, double duration);

/// Throws std::invalid_argument for times outside of the trajectory's.
Samples sample(const Problem& problem, const Solution& solution, const std::vector<double>& times);

/// What a plot of a converged result shows, with those of a search beside it. Each path has equal steps, and
/// more in each element, which is short where the motion is fast.
Picture picture_of(const Problem& problem, const Result& result, const Annotation& annotation);

}  // namespace extremal
