#pragma once

#include "action/scheme.hpp"

/// \file How long a window may be where V'' is bounded.

namespace extremal {

/// The sharp bound of ω0·n·h: where V'' ≤ ω0² M everywhere, M constant, the discrete action of n equal
/// elements with fixed ends is convex if n·h is shorter, and for the oscillator of that frequency it is not
/// if n·h is longer. It is where the second variation of that oscillator becomes singular:
///   midpoint 2n tan(π/2n), trapezoid 2n sin(π/2n) (n ≥ 2), lobatto(2) √8 for n = 1; π as n → ∞.
/// Infinite where nothing is free to vary (one element of degree 1) or where the quadrature does not see what
/// varies. `exact` quadrature with `scheme.points` points. Throws std::invalid_argument unless elements >= 1.
double window_bound(const Scheme& scheme, int elements);

}  // namespace extremal
