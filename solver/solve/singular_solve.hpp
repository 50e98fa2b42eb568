#pragma once

#include <functional>
#include <string>

#include "problem/singular_ends.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Extremals with ends at which L is infinite.

namespace extremal {

/// The solution of a problem by that of its smoothed() one: the trajectory in q and t, on elements that
/// become geometrically shorter towards singular ends.
Solution in_time(const Problem& problem, const EndVariables& variables, const Solution& smooth);

/// What to say where ∫ L dt is infinite towards an end.
std::string infinite_action(bool at_end);

/// Solves a problem of given duration.
using FixedSolve = std::function<Solution(const Problem&)>;

/// With a free duration: that T for which the energy of the extremal is the one given, or the condition on
/// its ends holds, by the secant rule, within brackets once there are any.
Solution solve_for_duration(const Problem& problem, const SolveOptions& options, const FixedSolve& solve);

}  // namespace extremal
