#pragma once

#include <functional>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Extremals to and from equilibria at infinity, by problems of finite duration.

namespace extremal {

/// How a problem of finite duration is solved: from the guess alone, or from other guesses as well.
using FiniteSolve = std::function<Solution(const Problem&, const SolveOptions&, bool near_guess)>;

/// An extremal of a problem with infinite ends. On the part [0, T] an infinite end is free, with the cost of
/// the linear motion beyond it (Beyn, IMA J. Numer. Anal. 10 (1990) 379): the problem stays variational. T
/// grows until the part that is added changes the rest by no more than the tolerance allows.
Solution solve_infinite(const Problem& problem, const SolveOptions& options, const FiniteSolve& solve);

}  // namespace extremal
