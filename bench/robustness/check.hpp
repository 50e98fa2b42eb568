#pragma once

#include <string>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

namespace bench {

/// Largest range (max − min) of a coordinate.
double range_of(const extremal::Trajectory& trajectory);

/// What shows that a solution is none, or that its error estimate is below a hundredth of its error; empty
/// where nothing does. By integration from piece to piece, which shares nothing with the discrete action.
std::string disproof(const extremal::Problem& problem, const extremal::Solution& solution, double tolerance);

}  // namespace bench
