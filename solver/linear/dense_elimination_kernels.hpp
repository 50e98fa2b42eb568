#pragma once

#include "machine/simd.hpp"

/// \file What the kernels of the dense symmetric elimination and symmetric_elimination.cpp agree on. Kernels
/// are built once for each instruction set, so nothing here is inline.

namespace extremal {

/// A symmetric matrix by its upper triangle, rows of `stride` doubles: `pivots` rows, padded to `half`, then
/// the rows of the rest. Columns likewise. Padding is zero.
struct DenseEliminationShape {
  int pivots, half, rest, stride;
};

struct DenseEliminationMonitor {
  int positive, negative;
  double cancellation;  ///< (|a_ii| + Σ w²/|d|)/|d_i|, largest
};

struct DenseEliminationKernels {
  int padding;  ///< rows and columns are padded to multiples of it
  int block;    ///< rows of V, the work space
  /// LDLᵀ of the pivots without exchanges, in place: their rows become D Lᵀ, the rows of the rest the Schur
  /// complement. v: `block` rows; size, taken: `stride` doubles. False where a pivot is zero or not finite.
  bool (*eliminate)(const DenseEliminationShape& shape, double* m, double* v, double* size, double* taken,
                    DenseEliminationMonitor* monitor);
  /// After that: X with D Lᵀ X = the columns of the rest, in place in the rows of the pivots.
  void (*substitute)(const DenseEliminationShape& shape, double* m, double* v);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(DenseEliminationKernels dense_elimination_kernels())

}  // namespace extremal
