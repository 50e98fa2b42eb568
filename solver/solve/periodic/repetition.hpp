#pragma once

#include "problem/closing.hpp"
#include "solution/solution.hpp"

/// \file How often an orbit runs through itself.

namespace extremal {

/// The least m for which m segments close a path, R^m = 1 without a shift; 0 if there is none up to 64.
int segments_to_close(const ClosingMap& map);

/// Of a path with q(t + T) = R q(t) + c that closes after m segments: the most parts of mT after each of
/// which it is where it was, within `error`. 0 where it never moves. A number of parts that divide into
/// others shows by its prime factors, up to half as many as there are points of elements in mT, one after the
/// other.
int repetitions(const Trajectory& path, const ClosingMap& map, int segments, double error);

}  // namespace extremal
