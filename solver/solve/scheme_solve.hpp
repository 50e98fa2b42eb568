#pragma once

#include <functional>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file A scheme that the user names: the guesses from which its equations are solved.

namespace extremal {

/// For solutions without the scheme, from which it begins then: in a part of the time there is.
SolveOptions for_guesses(const SolveOptions& options);

/// `solve_freely` solves the problem without the scheme, `judge` makes a solution of a path.
Solution solve_with_scheme(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                           const std::function<Solution(const SolveOptions&)>& solve_freely,
                           const std::function<Solution(const Problem&, const Outcome&)>& judge);

}  // namespace extremal
