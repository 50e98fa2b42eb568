#pragma once

#include <Eigen/SparseCore>
#include <vector>

/// \file Signs of determinants.

namespace extremal {

/// Of a sparse square matrix of so many rows, by LU with pivoting; entries of one place add up. 0 where it is
/// singular or not finite.
int determinant_sign(const std::vector<Eigen::Triplet<double>>& entries, int rows);

}  // namespace extremal
