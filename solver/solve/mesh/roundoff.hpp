#pragma once

#include "machine/roundoff.hpp"

/// \file The multiples of roundoff that decide.

namespace extremal {

/// The largest relative error of one operation on sums of two doubles.
inline constexpr double extended_roundoff = 0x1p-106;

/// Newton's method is asked for corrections no smaller than this, relative to the range of a path: about nine
/// roundings, as many as the value of a polynomial of degree 8 sums up.
inline constexpr double least_correction = 1e-15;

/// Corrections and errors below this, relative to the range, may be roundoff that an almost singular second
/// variation amplifies, by up to 10⁷.
inline constexpr double amplified_roundoff = 1e-9;

/// Of a momentum ∂S_h/∂q(0), relative to the largest: a sum over the points and coordinates of one element,
/// of up to 10³ terms.
inline constexpr double momentum_roundoff = 1e-13;

/// Of forces that cancel along a body at rest, relative to stiffness times |q|: some hundred terms.
inline constexpr double force_roundoff = 1e-14;

}  // namespace extremal
