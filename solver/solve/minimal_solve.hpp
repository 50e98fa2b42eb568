#pragma once

#include <functional>
#include <optional>

#include "problem/minimal_problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Problems with constraints in minimal coordinates.

namespace extremal {

/// The solution that is near the guess in the coordinates of the problem's chart, or of the charts that
/// follow it; nothing where it has none, or where that way does not lead to a solution. `solve` finds one in
/// a chart from the guess alone.
std::optional<Solution> solve_minimal(
    const Problem& problem, const SolveOptions& options,
    const std::function<Solution(const MinimalProblem&, const SolveOptions&)>& solve);

}  // namespace extremal
