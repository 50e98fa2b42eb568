#pragma once

#include <vector>

#include "linear/chain.hpp"
#include "linear/dense.hpp"

/// \file A chain with a dense border of few columns.

namespace extremal {

/// The system [A C; R D] with A a chain, m columns C, m rows R (Cᵀ if symmetric) and an m × m corner D,
/// solved by the Schur complement S = D − R A⁻¹ C.
///
/// A may be singular while the system is not (a phase condition removes a symmetry). Chain::factor() then
/// factors A' = A + E Σ Eᵀ, with E unit vectors and Σ diagonal. With y = −Σ Eᵀ x, the same system is
///
///     A' x + C z + E y = b,   R x + D z = c,   Eᵀ x + Σ⁻¹ y = 0,
///
/// a border of m + r columns around a nonsingular chain, without any perturbation. In S below this
/// extension is included. Rows and columns of S are divided by the size of the terms they are the
/// difference of, so that its singular values compare with roundoff.
class Border {
 public:
  /// Sets the shape; keeps memory. `order` rows of A. Throws std::invalid_argument for a negative number.
  void resize(int order, int columns, bool symmetric = true);

  int columns() const { return columns_; }
  int order() const { return order_ + columns_; }

  double* column_block() { return c_.data(); }  ///< C, order × m, row-major
  double* row_block();                          ///< Rᵀ, order × m, row-major; throws if symmetric
  double* corner() { return d_.data(); }        ///< D, m × m, row-major

  /// Eigenvalues of A this small, relative, are left to the border unless more are asked for. Larger ones
  /// cost the elimination half of the digits at most, and two refinements bring those back.
  static constexpr double deflated_below = 1e-8;

  /// Factors the chain and S. False if the system is singular to working precision or not finite.
  bool factor(Chain& a, double deflated = deflated_below);
  /// Whether it was finite, and its inertia can be told.
  bool finite() const { return finite_; }

  /// X := K⁻¹ X for all order() rows, row-major with `columns` columns, with the chain that was factored.
  /// Refines on the whole system where the parts are much larger than the solution.
  /// Throws std::logic_error unless factor() has returned true.
  void solve(const Chain& a, double* x, int columns) const;

  /// X := the least-squares solution of minimum norm, where singular values of S at most `threshold` count as
  /// zero. Returns how many did. With a threshold of zero one null direction is not left out if X has a part
  /// along it on the left: roundoff in place of its singular value makes it the largest part of the solution.
  /// Throws std::logic_error if the last factor() met what is not finite.
  int solve_least_norm(const Chain& a, double* x, int columns, double threshold) const;

  /// Of the whole symmetric system: that of A' and of S, less that of Σ⁻¹ (Haynsworth).
  /// Eigenvalues of S at most `threshold` count as zero; it is raised to roundoff.
  Inertia inertia(double threshold = 0) const;

  /// Of S, decreasing; empty if there is no border.
  Eigen::VectorXd singular_values() const;
  double smallest_singular_value() const;  ///< infinite if there is no border
  double condition() const;                ///< of S; 1 if there is no border, infinite if S is singular

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  int order_ = 0, columns_ = 0, extended_ = 0;
  bool symmetric_ = true, finite_ = false, regular_ = false;
  std::vector<double> c_, r_, d_;
  RowMatrix w_;            // A'⁻¹ [C E]
  Eigen::MatrixXd schur_;  // scaled
  Eigen::VectorXd unit_;   // the sizes that S was divided by
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  Inertia chain_inertia_;  // of A'
  mutable RowMatrix first_, right_, small_, border_;

  Eigen::Map<const RowMatrix> block(const std::vector<double>& data) const;
  const std::vector<double>& rows() const { return symmetric_ ? c_ : r_; }
  void extend(const Chain& a, const std::vector<double>& data, RowMatrix& w) const;
  void form_schur(const Chain& a);
  template <class Solve>
  double eliminate(const Chain& a, double* x, int columns, const Solve& solve_schur) const;
  void residual(const Chain& a, const double* x, const double* b, double* r, int columns) const;
};

}  // namespace extremal
