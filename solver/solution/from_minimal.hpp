#pragma once

#include <optional>

#include "problem/minimal_problem.hpp"
#include "solution/solution.hpp"

/// \file Solutions with constraints, which are found in minimal coordinates.

namespace extremal {

/// The solution in all coordinates; nodes are on the manifold to roundoff. Nothing where its error exceeds
/// the tolerance, which is relative to the largest range of a coordinate; `accepted`: where more than the
/// error that it has in minimal coordinates does.
std::optional<Solution> from_minimal(const Problem& problem, const MinimalProblem& minimal, Solution solution,
                                     double tolerance, bool accepted = false);

}  // namespace extremal
