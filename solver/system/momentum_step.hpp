#pragma once

#include "machine/simd.hpp"

/// \file One step of the search for a momentum that H_pp couples to no other, at many points.

namespace extremal {

/// What a search is at: going on, at its end, or without a solution.
constexpr double searching = 0, solved = 1, lost = 2;

/// A step of this part of p, or from a residual of this part of v, is the last: it squares the error.
constexpr double last_step = 1e-8, last_residual = 1e-14;
/// A residual of this part of v that no step reduces is roundoff.
constexpr double unreduced_residual = 1e-10;
constexpr double smallest_damping = 0x1p-30;

/// Rows over the points.
struct MomentumRows {
  const double *v, *slope, *curvature;     ///< H_p and H_pp at the trial
  double *p, *trial, *step;                ///< accepted, tried, Newton's step
  double *state, *norm, *scale, *damping;  ///< as MomentumSearch keeps them
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(double advance_momentum(const MomentumRows& rows, int count))

}  // namespace extremal
