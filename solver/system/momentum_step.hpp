#pragma once

#include <cstddef>

#include "machine/simd.hpp"

/// \file Kernels of the search for momenta that H_pp couples, at many points.

namespace extremal {

/// What a search is at: going on, at its end, or without a solution.
constexpr double searching = 0, solved = 1, lost = 2;

/// A step of this part of p, or from a residual of this part of v, is the last: it squares the error.
constexpr double last_step = 1e-8, last_residual = 1e-14;
/// A residual of this part of v that no step reduces is roundoff.
constexpr double unreduced_residual = 1e-10;
constexpr double smallest_damping = 0x1p-30;

/// Momenta that H_pp couples, and its entries.
struct CoupledMomenta {
  int size;
  const int* momenta;
  const int* entries;  ///< size × size: row with H_pp; -1: zero
};

/// Rows over the points, `stride` apart.
struct MomentumRows {
  int count;
  std::ptrdiff_t stride;
  const double *v, *slopes;                ///< of all momenta; H_p and H_pp at the trial
  double *p, *trial, *step, *unit;         ///< of all: accepted, tried, Newton's step, units of 1/p
  double *state, *norm, *scale, *damping;  ///< of the coupled ones, as MomentumSearch keeps them
  double* work;                            ///< size · (size + 1) registers
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(void begin_momenta(const MomentumRows& rows, const CoupledMomenta& coupled))
EXTREMAL_DECLARE_AT_EACH_LEVEL(double advance_momenta(const MomentumRows& rows,
                                                      const CoupledMomenta& coupled))

/// Of the matrices in rows over the points, the inverses, likewise; not a number where one is singular.
struct InverseRows {
  int count;
  std::ptrdiff_t stride;
  const double* matrix;
  double* inverse;  ///< size × size
  double* work;     ///< 2 · size² registers
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(void invert_coupled(const InverseRows& rows, const CoupledMomenta& coupled))

}  // namespace extremal
