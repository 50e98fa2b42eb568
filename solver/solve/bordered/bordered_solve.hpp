#pragma once

#include <functional>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Problems with unknown constants, integrals, nonlinear conditions or waypoints.

namespace extremal {

/// The solution of a problem that has an extension: from the guess, then from guesses that are bent.
Solution solve_bordered(const Problem& problem, const SolveOptions& options);

/// Up to `most` solutions from these guesses, no two of which are `same`, sorted by action.
std::vector<Solution> solve_bordered_all(const Problem& problem, const SolveOptions& options, int most,
                                         const std::function<bool(const Solution&, const Solution&)>& same);

}  // namespace extremal
