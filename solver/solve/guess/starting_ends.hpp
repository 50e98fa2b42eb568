#pragma once

#include <vector>

#include "problem/problem.hpp"

/// \file The ends of a first path.

namespace extremal {

/// q(0) and q(T) (2n) to start from: the guess's, moved onto the boundary relation; without a guess
/// the shortest line: a coordinate given at one end stays constant, coupled ends have least norm.
std::vector<double> starting_ends(const Problem& problem);

/// Those ends moved as the boundary relation allows: its free unknowns change by noise of `size`, relative.
std::vector<double> moved_ends(const Problem& problem, std::vector<double> ends, double size, unsigned seed);

}  // namespace extremal
