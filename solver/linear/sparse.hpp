#pragma once

#include <memory>
#include <span>

#include "linear/inertia.hpp"
#include "machine/deadline.hpp"

/// \file Symmetric sparse systems of any structure (lattices, many bodies), by SuiteSparse.

namespace extremal {

/// A symmetric n × n matrix with a fixed pattern, factored again and again: ordering and symbolic analysis
/// once, then LDLᵀ by dense fronts (supernodal.hpp), which chooses pivots within a front only. It is
/// monitored like the chain; where it grows or meets a tiny pivot, UMFPACK's LU solves instead.
class SparseSymmetric {
 public:
  SparseSymmetric();
  ~SparseSymmetric();
  SparseSymmetric(SparseSymmetric&&) noexcept;
  SparseSymmetric& operator=(SparseSymmetric&&) noexcept;

  /// Entry k stands at (rows[k], columns[k]), in either triangle, and at its mirror image. Entries that share
  /// a place add up. False, and there is no pattern, if the deadline passes before it is ordered. Throws
  /// std::invalid_argument for an index outside 0 … n−1 or spans of different lengths, std::bad_alloc without
  /// memory.
  bool pattern(int n, std::span<const int> rows, std::span<const int> columns, const Deadline& deadline = {});

  /// One value for each entry of the pattern, in its order.
  double* values();

  /// Numerical factorisation. False if singular to working precision or not finite, or if the deadline
  /// passes before.
  bool factor(const Deadline& deadline = {});

  /// X := A⁻¹ X, row-major n × `columns`, refined once where the factors grew. Throws std::logic_error unless
  /// factor() has returned true. Not for two threads at a time.
  void solve(double* x, int columns);

  /// solve() of one column, to roundoff times growth: not refined.
  void solve_step(double* x);

  /// Signs of the eigenvalues of the last factor(), by Sylvester's law. After the factorisation by fronts
  /// those of a matrix that differs from A, scaled, by roundoff times growth, less than 1e-9. Otherwise from
  /// LDLᵀ of A + σI and A − σI (A scaled to entries of at most 1): the negative eigenvalues of the first and
  /// the positive ones of the second are those of A beyond σ, and what is left counts as zero. σ is the
  /// smallest power of ten for which roundoff times growth stays below σ on both sides: a zero pivot becomes
  /// ±σ and lets the factors grow to 1/σ, so 1e-7 serves it. Where no σ below 1e-3 serves, all eigenvalues
  /// count as zero.
  Inertia inertia();

  bool pivoted() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace extremal
