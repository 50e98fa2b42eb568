#pragma once

#include <functional>
#include <optional>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Problems with constraints in minimal coordinates.

namespace extremal {

/// The solution that is near the guess in the coordinates of the problem's chart; nothing where it has none,
/// or where that way does not lead to a solution. `solve` finds one from the guess alone.
std::optional<Solution> solve_minimal(
    const Problem& problem, const SolveOptions& options,
    const std::function<Solution(const Problem&, const SolveOptions&)>& solve);

}  // namespace extremal
