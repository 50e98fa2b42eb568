#pragma once

/// \file Roundoff: its unit, and the multiples of it that decide.

namespace extremal {

/// Relative error of one rounding to the nearest double; and of one operation on sums of two doubles.
inline constexpr double unit_roundoff = 0x1p-53, extended_roundoff = 0x1p-106;

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
