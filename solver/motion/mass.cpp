#include "motion/mass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace extremal {

MassMatrix::MassMatrix(int size) : size_(size) {}

bool MassMatrix::factor(const std::vector<Triplet>& entries) {
  largest_ = 0;
  for (const Triplet& m : entries) largest_ = std::max(largest_, std::abs(m.value));
  if (dense()) {
    matrix_.setZero(size_, size_);
    for (const Triplet& m : entries) matrix_(m.row, m.column) += m.value;
    dense_.compute(matrix_);
    if (!(dense_.matrixLU().diagonal().cwiseAbs().minCoeff() > 0)) return false;
    if (size_ <= most_inverted) inverse_ = dense_.inverse();
    return true;
  }
  std::vector<Eigen::Triplet<double>> list;
  for (const Triplet& m : entries) list.emplace_back(m.row, m.column, m.value);
  sparse_matrix_.resize(size_, size_);
  sparse_matrix_.setFromTriplets(list.begin(), list.end());
  sparse_.compute(sparse_matrix_);
  return sparse_.info() == Eigen::Success;
}

void MassMatrix::solve(std::span<double> x) {
  Eigen::Map<Eigen::VectorXd> right(x.data(), size_);
  if (!dense()) {
    right = Eigen::VectorXd(sparse_.solve(right));
    return;
  }
  if (size_ <= most_inverted) {
    std::array<double, most_inverted> left;
    for (int a = 0; a < size_; ++a) {
      left[a] = 0;
      for (int b = 0; b < size_; ++b) left[a] += inverse_(a, b) * x[b];
    }
    std::copy_n(left.begin(), size_, x.begin());
    return;
  }
  right = dense_.permutationP() * right;
  dense_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(right);
  dense_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(right);
}

}  // namespace extremal
