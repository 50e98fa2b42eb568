#pragma once

#include <Eigen/Core>
#include <memory>

#include "linear/sparse_lu.hpp"

/// \file Directions in which a large sparse matrix is singular, and solutions across them.

namespace extremal {

/// The null directions of a sparse square matrix A of few: with B and C of as many columns as there are null
/// directions and in general position, the bordered matrix [A B; Cᵀ 0] is regular, and
///   [A B; Cᵀ 0] [V; Σ] = [0; 1]
/// gives A V = −BΣ, where Σ is as small as A is singular along V. With the left directions W for B and the
/// right ones V for C the solution of [A W; Vᵀ 0] [x; y] = [b; 0] is that of least norm of A x = b, less what
/// of b no x reaches (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000,
/// chapter 3).
class NullDirections {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// False if there is none with singular values below `threshold` whose complement is regular. The entries
  /// of A are of size 1.
  bool find(const Matrix& a, double threshold);

  /// Columns that span them, orthonormal; after find().
  const Eigen::MatrixXd& directions() const { return directions_; }

  /// The solution of least norm.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  /// A vector in general position; others for other k.
  static Eigen::VectorXd probe(Eigen::Index size, int k);

 private:
  /// Factors [a b; cᵀ 0]. False if it is singular.
  bool factor(const Matrix& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& c);

  std::unique_ptr<Eigen::SparseLU<Matrix>> bordered_;
  Eigen::MatrixXd directions_;
  int count_ = 0;
};

}  // namespace extremal
