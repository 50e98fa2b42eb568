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

/// Coordinates and velocities at that many equal steps' ends.
Samples sampled(const Trajectory& trajectory, int count);

/// Adds its spectrum to a converged result, whose message says where lines do not describe the motion.
void add_spectrum(const Study& study, const SpectrumRequest& request, Result& result);

/// What a plot of a converged result shows, with those of a search beside it. Each path has equal steps, and
/// more in each element, which is short where the motion is fast. With `saved`, samples of the result that
/// are equal steps and no fewer are drawn instead: a page that is made of the file of the result later is the
/// same.
Picture picture_of(const Problem& problem, const Result& result, const Annotation& annotation,
                   bool saved = false);

/// Rates that are infinite at an end, NaN in samples, become those beside it: so they are drawn.
void bound_ends(Samples& samples);

/// Gives a converged result that has samples what its pages show beside them. Throws as annotation() does.
void add_surroundings(const Study& study, Result& result);

}  // namespace extremal
