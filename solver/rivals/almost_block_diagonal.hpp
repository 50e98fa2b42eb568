#pragma once

#include <vector>

#include "linear/dense.hpp"

/// \file The linear system of multiple shooting.

namespace extremal {

/// Unknowns y, x_1 … x_m (b each) and, where there is one, τ:
///   Φ_0 y − x_1 + f_0 τ = c_0,   Φ_k x_k − x_{k+1} + f_k τ = c_k,   Y y + X x_m + g τ = c_m.
/// Elimination from the left with row pivoting, so that growth along the chain costs no digits.
class AlmostBlockDiagonal {
 public:
  struct Blocks {
    std::vector<Eigen::MatrixXd> transition;  ///< Φ_0 is b × (entries of y), the others b × b
    std::vector<Eigen::VectorXd> extra;       ///< f_k; empty where there is no τ
    Eigen::MatrixXd by_first, by_last;        ///< Y, X
    Eigen::VectorXd by_extra;                 ///< g
    bool may_be_singular = false;             ///< the shortest solution is wanted, as where a symmetry acts
  };
  void factor(const Blocks& blocks);

  struct Solution {
    Eigen::VectorXd first;              ///< y
    std::vector<Eigen::VectorXd> rest;  ///< x_1 … x_m
    double extra = 0;                   ///< τ
    bool finite() const;
  };
  /// `right` are c_0 … c_m.
  Solution solve(const std::vector<Eigen::VectorXd>& right) const;

 private:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Rows of two neighbours over the columns x_k, x_{k+1}, y, τ: the first b rows as they are solved for x_k,
  /// below them what is left; in place of the zeros, the multipliers.
  struct Elimination {
    Matrix rows;
    std::vector<int> exchange;
  };
  void eliminate(Elimination& stage) const;
  Eigen::MatrixXd substituted(const Blocks& blocks);
  Eigen::MatrixXd chained(const Blocks& blocks);
  Eigen::VectorXd solve_last(const Eigen::VectorXd& right) const;
  void substitute_back(const Elimination& stage, const double* right, Solution& solution, int k) const;

  int size_ = 0, first_ = 0, extra_ = 0;
  std::vector<Elimination> stages_;
  Eigen::MatrixXd through_, by_last_;  ///< of a single segment: x_1 by y and τ; X
  bool least_norm_ = false;
  Eigen::PartialPivLU<Eigen::MatrixXd> last_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> shortest_;
};

}  // namespace extremal
