#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Symmetries of a problem beside a solution.

namespace extremal {

/// Symmetries of the problem, found about a path and nearer to the origin: at some of those points forces
/// count.
std::vector<Generator> symmetries_about(const Problem& problem, const Trajectory& found);

}  // namespace extremal
