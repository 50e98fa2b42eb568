#pragma once

#include "machine/simd.hpp"

/// \file What the kernels of a sparse factorisation and supernodal.cpp agree on. Kernels are built once for
/// each instruction set, so nothing here is inline.

namespace extremal {

/// A front: rows of `stride` doubles, a row a pivot. Their first `half` columns are those of the pivots,
/// padded, then come those of what the pivots are coupled with, padded too. With W = D Lᵀ
/// and V = Lᵀ as for the chain (chain_large.simd.cpp), U = −(what is left for later) holds the upper triangle
/// over the latter columns.
struct FrontShape {
  int pivots, rest, half, stride;
};

struct FrontMonitor {
  double most;          ///< Σ w²/|d| on the diagonal, largest
  double cancellation;  ///< (|a_ii| + Σ w²/|d|)/|d_i|, largest
  int positive, negative;
};

struct FrontKernels {
  int padding;  ///< columns are padded to multiples of it

  /// LDLᵀ of W with 1×1 and 2×2 pivots chosen among the pivots of the front: order[i] becomes the pivot (of
  /// 0 … pivots − 1) that was taken as number i. `diagonal` has two doubles for each: 1/d and 0, or the
  /// inverse of a 2×2 block [d0 e; e d1] as (d0, e), (d1, e). size: |a_ii| of the pivots. taken: Σ w²/|d| of
  /// each column so far. False if there is no pivot but zero, or one is not finite.
  bool (*eliminate)(const FrontShape& shape, double* w, double* v, int* order, double* diagonal, double* size,
                    double* taken, double* work, FrontMonitor* monitor);
  /// U −= Vᵀ W over the columns of the rest, in the rows from `first` to `end`, multiples of the padding.
  void (*update)(const FrontShape& shape, const double* v, const double* w, double* u, int first, int end);
  /// Adds U of a front to the front that comes next: column k of the rest goes to column to[k] there, W or,
  /// from its half on, U; run[k] is where the contiguous columns from k on end.
  void (*extend)(const FrontShape& child, const double* u, const int* to, const int* run,
                 const FrontShape& shape, double* w, double* parent_u);
  /// L y = y for the pivots, taken in order; rest −= L_rest y. Then y := D⁻¹ y.
  void (*forward)(const FrontShape& shape, const double* v, const double* diagonal, double* y, double* rest);
  /// y := L⁻ᵀ (y − L_restᵀ rest).
  void (*backward)(const FrontShape& shape, const double* v, double* y, const double* rest);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(FrontKernels front_kernels())

}  // namespace extremal
