#pragma once

#include "problem/problem.hpp"
#include "solution/solution.hpp"

namespace extremal {

/// The problem with a solution as its guess.
Problem guessed_by(const Problem& problem, const Solution& solution);

}  // namespace extremal
