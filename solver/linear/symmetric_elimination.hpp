#pragma once

#include <cstddef>
#include <vector>

#include "linear/dense_elimination_kernels.hpp"
#include "linear/inertia.hpp"
#include "machine/aligned.hpp"

/// \file Elimination of the first unknowns of a dense symmetric matrix, for hundreds of them.

namespace extremal {

/// M = [A Bᵀ; B C], A of order `pivots` and C of order `rest`: LDLᵀ of A without exchanges, the inertia of A,
/// and C − B A⁻¹ Bᵀ or A⁻¹ Bᵀ. For a few unknowns Eigen's factorisations serve better.
class SymmetricElimination {
 public:
  SymmetricElimination();

  /// Sets the shape, all entries zero; keeps memory.
  void resize(int pivots, int rest);

  /// Row i of A from its diagonal on is pivot_row(i)[i …]; its part of Bᵀ stands at coupled_row(i)[0 …].
  double* pivot_row(int i) { return m_.data() + std::size_t(i) * shape_.stride; }
  double* coupled_row(int i) { return pivot_row(i) + shape_.half; }
  /// Row i of C from its diagonal on: rest_row(i)[i …].
  double* rest_row(int i) { return pivot_row(shape_.half + i) + shape_.half; }

  /// Eliminates the pivots: C becomes C − B A⁻¹ Bᵀ, its upper triangle. False where a pivot is zero, not
  /// finite, or so small against the terms it is the sum of that fewer digits than `least_digits` are left.
  bool eliminate();
  /// Whether the last eliminate() came to its end, though digits may be lost: near a singular matrix
  /// solutions still tell the null vector.
  bool completed() const { return completed_; }
  /// Signs of the eigenvalues of A, after eliminate().
  Inertia inertia() const { return {monitor_.positive, monitor_.negative, 0}; }
  /// After eliminate(): coupled_row(i) becomes row i of A⁻¹ Bᵀ.
  void substitute();

  /// Decimal digits that the pivots must keep.
  static constexpr int least_digits = 8;

 private:
  DenseEliminationKernels kernels_;
  DenseEliminationShape shape_ = {};
  DenseEliminationMonitor monitor_ = {};
  bool completed_ = false;
  AlignedDoubles m_, v_, work_;
};

}  // namespace extremal
