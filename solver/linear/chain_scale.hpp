#pragma once

#include <vector>

namespace extremal {

/// Powers of two s, one a row, that bring the largest |s_i a_ij s_j| of every row of a block-tridiagonal
/// matrix near 1 (Ruiz, RAL-TR-2001-034: each sweep divides both sides by the square root of the row's
/// largest entry). Blocks as in Chain, finite. A row of zeros keeps s = 1.
void equilibrate(const double* diagonal, const double* lower, int blocks, int size,
                 std::vector<double>& scale);

}  // namespace extremal
