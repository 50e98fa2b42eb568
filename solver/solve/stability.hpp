#pragma once

#include "analysis/variation.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Whether a periodic orbit is stable.

namespace extremal {

/// Sets the Floquet multipliers of a converged solution of a periodic problem. `variation` is that of its
/// windows, where it has any. `size` of the solution: that its error is relative to.
void read_stability(const Problem& problem, const SecondVariation& variation, double size,
                    Solution& solution);

}  // namespace extremal
