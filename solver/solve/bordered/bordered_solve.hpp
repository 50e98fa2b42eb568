#pragma once

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Problems with unknown constants, integrals, nonlinear conditions or waypoints.

namespace extremal {

/// The solution of a problem that has an extension: from the guess, then from guesses that are bent.
Solution solve_bordered(const Problem& problem, const SolveOptions& options);

}  // namespace extremal
