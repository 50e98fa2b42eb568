#pragma once

#include <span>
#include <vector>

#include "linear/dense.hpp"
#include "linear/sparse_lu.hpp"
#include "system/lagrangian.hpp"

/// \file Solves with ∂²L/∂q'∂q'.

namespace extremal {

/// Dense for few coordinates, sparse for many; of very few the inverse, which is as exact and needs no
/// memory.
class MassMatrix {
 public:
  explicit MassMatrix(int size);
  /// False if a pivot is zero.
  bool factor(const std::vector<Triplet>& entries);
  /// x := M⁻¹ x.
  void solve(std::span<double> x);
  double largest() const { return largest_; }  ///< largest entry

 private:
  bool dense() const { return size_ <= dense_limit; }
  static constexpr int dense_limit = 64, most_inverted = 3;
  int size_;
  double largest_ = 0;
  Eigen::MatrixXd matrix_, inverse_;
  Eigen::PartialPivLU<Eigen::MatrixXd> dense_;
  Eigen::SparseMatrix<double> sparse_matrix_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_;
};

}  // namespace extremal
