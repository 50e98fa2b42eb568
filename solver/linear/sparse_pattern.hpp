#pragma once

#include <span>
#include <vector>

namespace extremal {

/// Compressed columns: rows of column j are row[begin[j]] … row[begin[j+1] − 1], ascending.
struct SparsePattern {
  std::vector<int> begin, row;
  std::vector<int> slot;  ///< where values go or come from; see the functions that make it
};

/// The lower triangle with a full diagonal, of entries in either triangle; slot: where each entry goes.
SparsePattern lower_triangle(int n, std::span<const int> rows, std::span<const int> columns);

/// Both triangles; slot: which entry of the lower triangle each one is.
SparsePattern both_triangles(const SparsePattern& lower);

}  // namespace extremal
