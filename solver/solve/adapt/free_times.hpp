#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <string>
#include <vector>

#include "linear/sparse.hpp"
#include "solve/newton/equations.hpp"

/// \file Times of the nodes as unknowns: S_h is stationary in them too.

namespace extremal {

/// ∂S_h/∂t_k = E_k − E_{k−1} = 0 says that all elements have the same discrete energy E_k = −∂L_d/∂h_k, h_k
/// their lengths (Chen-Guo-Wu (3.3), (3.6); Kane, Marsden and Ortiz, J. Math. Phys. 40 (1999) 3353). Where T
/// is free, t_N is an unknown too, and its equation gives E_N. On equal elements E_k differs from a constant
/// by O(h^order). The times are found by Newton's method along
///   δS_h = 0,   ∂S_h/∂t_k = μ r_k
/// from equal elements, where μ = 1, to μ = 0.
///
/// S_h hardly changes when a node moves along the path: the Hessian in values and times is singular but for
/// O(h^order). Its steps are sought in times and in values at nodes that move with the path,
/// δq = δx + q' δt: what cancels is then in the entries, and no longer in the factors.
class FreeTimes {
 public:
  /// `problem`, of an L that does not depend on t, and `tables` must outlive it.
  FreeTimes(const Problem& problem, const ElementTables& tables, int elements);

  struct Report {
    bool reached = false;
    std::string failure;  ///< with the node at which it fails
  };
  /// From an extremal of its elements to one with free times; else the path is on the way there. `on_step`
  /// says after each step whether there may be more.
  Report find(Path& path, const std::function<bool()>& on_step);

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  void evaluate(const Path& path);
  double imbalance(const Path& path, double mu) const;
  Sparse hessian() const;
  Sparse moving_with(const Path& path) const;
  bool solve(const Path& path, double mu);
  bool apply(Path& path) const;
  bool correct(Path& path, double mu, const std::function<bool()>& on_step);
  std::string failure(const Path& from, const Path& path) const;

  const Problem& problem_;
  const int elements_, times_;  ///< unknown ones, t_1 first
  DiscreteAction action_;
  Equations equations_;
  LengthDerivatives lengths_;
  SparseSymmetric matrix_;
  std::vector<double> entries_;      ///< of the Hessian in the path
  Eigen::VectorXd slope_, unequal_;  ///< ∂S_h/∂t_k, less the energy given for t_N; r
  Eigen::VectorXd step_;             ///< of values that move with the path, moves of nodes, and T
};

}  // namespace extremal
