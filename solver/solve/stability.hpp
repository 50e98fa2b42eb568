#pragma once

#include "analysis/multipliers.hpp"
#include "analysis/variation.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Whether a periodic orbit is stable.

namespace extremal {

/// How an orbit of a periodic problem closes; `relative_error` of its coordinates.
ClosedOrbit closed_orbit(const Problem& problem, double relative_error);

/// Sets the Floquet multipliers of a converged solution of a periodic problem. `variation` was
/// assembled for it, perhaps without success. `size` of the solution: that its error is relative to.
void read_stability(const Problem& problem, const SecondVariation& variation, double size,
                    Solution& solution);

}  // namespace extremal
