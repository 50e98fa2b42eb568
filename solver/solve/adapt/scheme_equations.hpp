#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "linear/sparse.hpp"
#include "solve/newton/equations.hpp"

/// \file The equations of a scheme in all unknowns of a path, the times of its nodes among them where they
/// are free.

namespace extremal {

/// ∂S_h/∂t_k = E_k − E_{k−1} = 0 says that all elements have the same discrete energy E_k = −∂L_d/∂h_k, h_k
/// their lengths (Chen-Guo-Wu (3.3), (3.6); Kane, Marsden and Ortiz, J. Math. Phys. 40 (1999) 3353). Where T
/// is free, t_N is an unknown too, and its equation gives E_N.
///
/// S_h hardly changes when a node moves along the path: the Hessian in values and times is singular but for
/// O(h^order). Steps are sought in times and in values at nodes that move with the path, δq = δx + q' δt:
/// what cancels is then in the entries, and no longer in the factors.
class SchemeEquations {
 public:
  using Vector = Eigen::VectorXd;  ///< over the unknowns of the path, then times: t_1, …; steps may have more

  /// `problem` and `tables` must outlive it. With `free_times` L must not depend on t; without, T is fixed.
  SchemeEquations(const Problem& problem, const ElementTables& tables, int elements, bool free_times);

  int unknowns() const { return equations_.unknowns() + times_; }
  /// What is left of the equations at a path; not finite where the action is not.
  const Vector& evaluate(const Path& path);
  /// The largest of them, relative to the largest momentum, and of times to that times the largest velocity;
  /// where evaluated last.
  double size(const Vector& left, const Path& path) const;

  /// Factors the second variation of the path evaluated last. False if it is singular.
  bool factor(const Path& path);
  /// The step, in values that move with the path and in times, for a right-hand side.
  Vector solve(const Vector& right);
  /// False, and the path is not to be used, if an element would become too short or too long for one step.
  bool apply(Path& path, const Vector& step, double factor) const;
  /// Mean square of steps, of values by the extent of the path, and of times by the mean length of elements.
  double product(const Vector& a, const Vector& b, const Path& path, double extent) const;

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  Sparse hessian() const;
  Sparse moving_with(const Path& path) const;

  const Problem& problem_;
  const int elements_, times_;  ///< unknown ones, t_1 first
  DiscreteAction action_;
  Equations equations_;
  LengthDerivatives lengths_;
  SparseSymmetric matrix_;
  Sparse moving_;
  std::vector<double> entries_;  ///< of the Hessian in the path
  Vector left_;
};

}  // namespace extremal
