#pragma once

#include <functional>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Problems in phase space, see system/phase_space.hpp.

namespace extremal {

/// Solves a problem from its guess, with a search for other starting paths or without (`near_guess`).
using PhaseSpaceSolver =
    std::function<Solution(const Problem& problem, const SolveOptions& options, bool near_guess)>;

/// The stationary path on which Hamilton's equations hold: from the guess; then from a path on which they
/// nearly hold, where the guess leads to one; then by a search. Coordinates and momenta meet the tolerance,
/// each of their ranges.
Solution solve_in_phase_space(const Problem& problem, const SolveOptions& options,
                              const PhaseSpaceSolver& solve);

}  // namespace extremal
