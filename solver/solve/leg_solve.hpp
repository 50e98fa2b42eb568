#pragma once

#include <functional>
#include <optional>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Waypoints that fix every coordinate at a given time. The action is a sum over the legs between them,
/// which have nothing in common: each leg is a problem of its own.

namespace extremal {

/// A problem with the solutions of its legs as guess. Nothing where legs are not separate, as where
/// constants, conditions or a free duration belong to all, or where one of them has no solution.
std::optional<Problem> guessed_by_legs(const Problem& problem,
                                       const std::function<Solution(const Problem&)>& solve);

}  // namespace extremal
