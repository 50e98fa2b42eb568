#pragma once

#include "analysis/windows.hpp"
#include "solve/solve.hpp"

/// \file What the second variation with fixed ends along a solution tells of it.

namespace extremal {

/// Sets windows, conjugate times and certificate of a converged solution. Where its ends are fixed and nearly
/// conjugate, adds to error_estimate the roundoff that this amplifies; where they are conjugate within the
/// error, or the roundoff exceeds the tolerance, the solution has not converged: status and message then say
/// so. `memory` is kept between solves.
void read_minimality(const Problem& problem, const SolveOptions& options, SecondVariation& memory,
                     Solution& solution);

}  // namespace extremal
