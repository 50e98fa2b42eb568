#pragma once

#include "machine/simd.hpp"

/// \file Kernels that carry motions side by side, one in each lane. Kernels include this: no inline functions
/// here. Rows are groups of one double for each lane, aligned to their size.

namespace extremal {

/// A matrix entry that has a value in each lane.
struct LaneEntry {
  int row, column;
  const double* value;
};

/// A stage of a Runge-Kutta method: how much of it is taken.
struct LaneStage {
  double weight;
  const double* slope;
};

struct LaneKernels {
  /// out = y + h Σ weight × slope, over rows; h has a value a lane.
  void (*combine)(const double* y, const double* h, const LaneStage* stages, int count, double* out,
                  int rows);
  /// Row `row` of y += ± value × row `column` of x, for each entry and each of `columns` blocks of rows.
  void (*add_products)(const LaneEntry* entries, int count, double sign, const double* x, double* y,
                       int columns, long x_stride, long y_stride);
  /// Sums over a block of rows of (Σ first × slope / s)² and (Σ second × slope / s)², where s is `tolerance`
  /// times the largest of y and next there; added to the first and the second group of `sums`.
  void (*add_errors)(const double* y, const double* next, const LaneStage* first, int first_count,
                     const LaneStage* second, int second_count, double tolerance, double* sums, int rows);
  /// LDLᵀ of n × n rows [i*n + j], i >= j, in place, with inverted pivots; and the solve for blocks of n
  /// rows.
  void (*factor)(double* matrix, int n);
  void (*solve)(const double* factors, int n, double* x, int columns, long stride);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(LaneKernels lane_kernels())

}  // namespace extremal
