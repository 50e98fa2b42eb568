#pragma once

#include <optional>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Waypoints that fix every coordinate at a given time. The action is a sum over the legs between them,
/// which have nothing in common: each leg is a problem of its own.

namespace extremal {

/// One of them, with the time at which it begins.
struct LegProblem {
  Problem problem;
  double from;
};

/// Nothing where legs are not separate, as where constants, conditions or a free duration belong to all.
std::optional<std::vector<LegProblem>> separate_legs(const Problem& problem);

/// A problem with paths of its legs as guess.
Problem guessed_by_legs(const Problem& problem, const std::vector<LegProblem>& legs,
                        const std::vector<const Trajectory*>& paths);

/// Of the actions of each leg's extremals, up to `most` choices of one for each leg: those of least sum, in
/// ascending order.
std::vector<std::vector<int>> least_combinations(const std::vector<std::vector<double>>& actions, int most);

}  // namespace extremal
