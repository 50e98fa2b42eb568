#pragma once

#include "problem/problem.hpp"

/// \file Closed paths that came to rest.

namespace extremal {

/// Whether a closed path has shrunk onto an equilibrium, which has every duration: its range against that of
/// the path it was started from. A path that rested at first was asked for.
bool shrank(const Problem& problem, double range, double first_range);
/// The same of one with forces beside which all seem to close: as they do to first order beside an
/// equilibrium without damping.
bool closes_by_smallness(double range, double first_range);
inline constexpr const char* shrank_to_rest = "the orbit shrank to a point of equilibrium";

}  // namespace extremal
