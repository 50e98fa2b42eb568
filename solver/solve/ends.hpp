#pragma once

#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The ends of a path and the boundary relation.

namespace extremal {

/// q(0) and q(T) of a path (2n).
std::vector<double> ends_of(const Path& path);

/// q(0) and q(T) (2n) to start from: the guess's, moved onto the boundary relation; without a guess
/// the shortest line: a coordinate given at one end stays constant, coupled ends have least norm.
std::vector<double> starting_ends(const Problem& problem);

/// Those ends moved as the boundary relation allows: what it leaves free by noise of `size`, relative.
std::vector<double> moved_ends(const Problem& problem, std::vector<double> ends, double size, unsigned seed);

/// Moves the ends of a path onto the boundary relation, as little as can be.
void meet_ends(const Problem& problem, Path& path);

/// After a step along the relation: the ends that follow from free ones, to twice the digits. What rounding
/// takes from steps would add up, to more than roundoff where they were long.
void keep_ends(const EndMap& ends, Path& path);

}  // namespace extremal
