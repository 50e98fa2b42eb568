#pragma once

#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The guess as a path.

namespace extremal {

/// q(0) and q(T) (2n) to start from: the guess's, moved onto the boundary relation; without a guess
/// the shortest line: a coordinate given at one end stays constant, coupled ends have least norm.
std::vector<double> starting_ends(const Problem& problem);

/// Fills `path` (already reset) from the guess. A guess is shifted linearly in t so that its ends are
/// `ends`. `bend` moves the default guess aside, in units of its length; 0 leaves it.
void start_path(const Problem& problem, const std::vector<double>& ends, const ElementTables& tables,
                double bend, Path& path);

}  // namespace extremal
