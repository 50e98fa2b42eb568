#pragma once

#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The ends of a path and the boundary relation.

namespace extremal {

/// q(0) and q(T) of a path (2n).
std::vector<double> ends_of(const Path& path);

/// The ends (2n) that satisfy the boundary relation, nearest to `target`.
std::vector<double> nearest_ends(const EndMap& ends, const std::vector<double>& target);

/// Moves the ends of a path onto the boundary relation, as little as can be.
void meet_ends(const Problem& problem, Path& path);

/// After a step along the relation: the ends that depend on free ones, to twice the digits. Without it the
/// rounding of long steps would add up to more than roundoff.
void keep_ends(const EndMap& ends, Path& path);

}  // namespace extremal
