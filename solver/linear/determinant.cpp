#include "linear/determinant.hpp"

#include <algorithm>
#include <cmath>

#include "linear/sparse_lu.hpp"

namespace extremal {

int determinant_sign(const std::vector<Eigen::Triplet<double>>& entries, int rows) {
  if (!std::ranges::all_of(entries, [](const auto& e) { return std::isfinite(e.value()); })) return 0;
  Eigen::SparseMatrix<double> matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
  lu.compute(matrix);
  return lu.info() == Eigen::Success ? static_cast<int>(lu.signDeterminant()) : 0;
}

}  // namespace extremal
