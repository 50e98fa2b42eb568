#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "linear/sparse.hpp"

/// \file A sparse symmetric matrix with a border of few dense columns.

namespace extremal {

/// The system [H C; R D] by the Schur complement S = D − R H⁻¹ C, of which the first column may have a row of
/// its own and the others, directions that are held, have themselves. H may be null along these: factored
/// is A = H + κ E Eᵀ with E unit vectors, one for each. With y = −κ Eᵀx the same system is
///
///     A x + C z + E y = b,   R x + D z = c,   Eᵀx + y/κ = 0,
///
/// a border of more columns around a matrix that is not null there, without any perturbation.
class SparseBorder {
 public:
  /// The directions to be held, unknowns × count; in place of those before.
  void hold(Eigen::MatrixXd directions);
  int held() const { return static_cast<int>(directions_.cols()); }
  /// The unknowns of E.
  const std::vector<int>& pinned() const { return pinned_; }

  /// Solves for the border, with A factored. `first` is the column before the held ones, or empty.
  void factor(SparseSymmetric& a, double kappa, std::span<const double> first);
  /// x := the solution for the right-hand side x and `value`, that of the first row, which is given with the
  /// corner. Returns the first unknown of the border; 0 without one. `refine` as
  /// QuadraticModel::set_refining.
  double solve(SparseSymmetric& a, std::span<double> x, std::span<const double> row, double corner,
               double value, bool refine) const;
  /// Of H across the directions that are held, which count as null; with the first column, if it is given,
  /// and the corner.
  Inertia inertia(SparseSymmetric& a, std::span<const double> first, double corner) const;

 private:
  Eigen::MatrixXd schur(std::span<const double> row, double corner) const;

  Eigen::MatrixXd directions_;  ///< of length one
  std::vector<int> pinned_;
  int first_ = 0;  ///< columns before those
  double kappa_ = 1;
  Eigen::MatrixXd solved_;  ///< A⁻¹ [first, directions, E]
};

}  // namespace extremal
