#pragma once

#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The guess as a path.

namespace extremal {

/// q(0) and q(T) (2n) to start from: the guess's, moved onto the boundary relation; without a guess
/// the shortest line: a coordinate given at one end stays constant, coupled ends have least norm.
std::vector<double> starting_ends(const Problem& problem);

/// Fills `path` (already reset) from the guess, shifted linearly in t so that its ends are `ends`.
void start_path(const Problem& problem, const std::vector<double>& ends, const ElementTables& tables,
                Path& path);

/// Smooth deterministic noise, the same for the same seed: Σ_m c_m sin(mπ t/T) with m <= 3, the ends at rest.
struct Bend {
  double size = 0;  ///< of each coordinate, in units of its extent
  unsigned seed = 0;
};
void bend_path(const Bend& bend, const ElementTables& tables, Path& path);

}  // namespace extremal
