#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

/// \file The symmetric block-tridiagonal matrix of the nodes between elements, its factorisation with
/// inertia, and solves with many right-hand sides. Bordered and cyclic systems are solved with it by
/// their Schur complement (border.hpp).

namespace extremal {

/// Signs of the eigenvalues of a symmetric matrix.
struct Inertia {
  int positive = 0, negative = 0, zero = 0;
  bool operator==(const Inertia&) const = default;
};

/// A = tridiag(Bᵀ, D, B) with `blocks` blocks of size n; D_k = diagonal(k), symmetric, both triangles
/// filled; B_k = lower(k) couples row block k+1 with column block k. All blocks row-major n × n.
class Chain {
 public:
  /// Sets the shape; keeps memory. Contents are undefined afterwards.
  void resize(int blocks, int size);

  int blocks() const { return blocks_; }
  int size() const { return size_; }
  double* diagonal(int k) { return diagonal_.data() + std::size_t(k) * size_ * size_; }
  double* lower(int k) { return lower_.data() + std::size_t(k) * size_ * size_; }
  const double* diagonal(int k) const { return diagonal_.data() + std::size_t(k) * size_ * size_; }
  const double* lower(int k) const { return lower_.data() + std::size_t(k) * size_ * size_; }

  /// Factors a copy: LDLᵀ without pivoting, monitored; where a pivot is too small for the accuracy
  /// asked, LU with row pivoting over neighbouring blocks. False if A is singular to working precision or
  /// not finite. The blocks stay as they were set.
  bool factor();

  /// X := A⁻¹ X. X has `columns` columns: entry (block k, row i, column c) at
  /// x[(k*size + i)*columns + c]. Refines once where the factorisation was not the plain one.
  void solve(double* x, int columns) const;

  /// Of the last factor(). Counted from the pivots; after pivoting from shifted factorisations.
  Inertia inertia() const { return inertia_; }
  bool pivoted() const { return pivoted_; }

 private:
  int blocks_ = 0, size_ = 0;
  bool pivoted_ = false;
  Inertia inertia_;
  std::vector<double> diagonal_, lower_;
  std::vector<double> factor_, factor_lower_;
  struct Pivoted;
  std::shared_ptr<Pivoted> pivoted_factor_;
};

}  // namespace extremal
