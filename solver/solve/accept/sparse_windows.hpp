#pragma once

#include <array>
#include <optional>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Windows of many coordinates, few of them coupled.

namespace extremal {

/// How much of a path minimises, told without its Jacobi fields, which fill n × n matrices.
struct SparseWindows {
  /// In (0, T) as many times are conjugate to 0, by Morse's theorem.
  int conjugate_times = 0;
  /// As Minimality has them, but shorter than the longest by up to one part in a thousand.
  std::vector<std::array<double, 2>> windows;
};

/// Windows from the inertia of δ²S with fixed ends of parts of the path, all unknowns of a part at once in a
/// sparse matrix. Nothing where a part is singular to working precision, or its elements do not resolve the
/// field that vanishes at both its ends. `index` is that of the path on its own elements between fixed ends,
/// if it is known.
std::optional<SparseWindows> sparse_windows(const Problem& problem, const Trajectory& trajectory,
                                            std::optional<int> index);

}  // namespace extremal
