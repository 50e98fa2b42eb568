#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "linear/chain_kernels.hpp"
#include "linear/chain_pivoted.hpp"
#include "linear/inertia.hpp"
#include "machine/aligned.hpp"
#include "machine/roundoff.hpp"

/// \file The symmetric block-tridiagonal matrix of the nodes between elements, its factorisation with
/// inertia, and solves with many right-hand sides. Bordered systems are solved with it by their
/// Schur complement (border.hpp).

namespace extremal {

/// A = tridiag(Bᵀ, D, B) with `blocks` blocks of size n; D_k = diagonal(k), symmetric, both triangles
/// filled; B_k = lower(k) couples row block k+1 with column block k. All blocks row-major n × n.
class Chain {
 public:
  /// Sets the shape; keeps memory. Contents are undefined afterwards. No blocks at all is a shape too.
  /// Throws std::invalid_argument for a negative number of blocks or a size below 1.
  void resize(int blocks, int size);

  int blocks() const { return blocks_; }
  int size() const { return size_; }
  int order() const { return blocks_ * size_; }
  double* diagonal(int k) { return diagonal_.data() + std::size_t(k) * size_ * size_; }
  double* lower(int k) { return lower_.data() + std::size_t(k) * size_ * size_; }
  const double* diagonal(int k) const { return diagonal_.data() + std::size_t(k) * size_ * size_; }
  const double* lower(int k) const { return lower_.data() + std::size_t(k) * size_ * size_; }

  /// Factors a copy: LDLᵀ without pivoting, monitored; where a pivot is too small for the accuracy
  /// asked, LDLᵀ with chosen 1×1 and 2×2 pivots (chain_pivoted.hpp). The blocks stay as they were set.
  ///
  /// False if A is not finite, if it has more null directions than are worth finding, or if eigenvalues at
  /// most `smallest` were found, after scaling rows and columns to a largest entry of 1; `smallest` is raised
  /// to roundoff, so by default this says that A is singular to working precision. Each such eigenvalue is
  /// counted as zero. It is then moved to about 1 by adding to one diagonal entry, where its eigenvector is
  /// largest, and that is listed in deflated(): the factorisation is an exact one of a nonsingular matrix
  /// that is known.
  bool factor(double smallest = 0);

  /// The inertia alone, as pivots tell it without a search for null directions: that of a matrix whose
  /// entries differ from those of A by at most `sign_error`, relative to the largest of a block. Nothing if A
  /// is not finite. There is no factorisation then.
  std::optional<Inertia> signs();
  static constexpr double sign_error = wild_growth * machine_epsilon;

  /// X := (A + Σ amount e_row e_rowᵀ over deflated())⁻¹ X; that is A⁻¹ X after factor() has returned true.
  /// X has `columns` columns: entry (block k, row i, column c) at x[(k*size + i)*columns + c]. Refines
  /// once where the factorisation was not the plain one (not for two threads at a time then).
  /// Throws std::logic_error if there is no factorisation of finite blocks.
  void solve(double* x, int columns) const;

  /// solve() of one column, to roundoff times growth: refined only where pivots were chosen.
  void solve_step(double* x) const;

  /// Y := A X, both laid out as in solve().
  void multiply(const double* x, double* y, int columns) const;

  /// Of the last factor(), counted from the pivots.
  Inertia inertia() const { return inertia_; }
  bool pivoted() const { return pivoted_; }
  std::span<const Deflation> deflated() const { return deflated_; }

 private:
  int blocks_ = 0, size_ = 0;
  bool factored_ = false, pivoted_ = false, refine_ = false;
  Inertia inertia_;
  ChainKernels kernels_ = {};
  AlignedDoubles diagonal_, lower_, factor_;
  PivotedChain pivoted_factor_;
  std::vector<Deflation> deflated_;
  std::vector<double> scale_;
  mutable std::vector<double> work_;

  double& diagonal_entry(int row);
  double factor_once(double smallest);
  int null_row(double smallest);
  void solve_factored(double* x, int columns) const;
};

}  // namespace extremal
