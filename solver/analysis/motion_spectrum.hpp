#pragma once

#include <vector>

#include "analysis/spectrum.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file The lines of each coordinate along a trajectory.

namespace extremal {

struct MotionSpectrum {
  std::vector<Spectrum> coordinates;  ///< in the order of the problem; not momenta
  /// Mean velocity of each coordinate, taken away before: not zero only on orbits that a map shifts, "a +
  /// 2*pi", and where it makes most of the way along an arc, as of an angle that turns over.
  std::vector<double> drift;
};

/// What of a trajectory is looked at. A scheme with equal elements has discrete trajectories of its own: the
/// values at the ends of elements, Müller-Ortiz (1.13). Else samples of q(t), close enough for what its
/// elements resolve.
enum class Sampling { dense, nodes };

/// Until `lines` (0: any number) are found, or the largest that is left is below `tolerance` times the
/// largest range of a coordinate. An orbit that closes, perhaps after some times its map, has exact multiples
/// of one frequency. One whose map has no finite order is continued by it. `nodes` must be equally spaced.
/// Throws std::invalid_argument where samples are too few.
MotionSpectrum motion_spectrum(const Problem& problem, const Trajectory& trajectory, Sampling sampling,
                               int lines, double tolerance);

}  // namespace extremal
