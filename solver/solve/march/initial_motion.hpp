#pragma once

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Motions from initial data: problem.initial.

namespace extremal {

/// The motion from problem.initial. Without a scheme, Gauss elements of a degree and of lengths that follow
/// from the tolerance; with one, so many equal elements as options.elements says or as the tolerance needs.
/// The error is that of a comparison with another march, of higher degree and with a much smaller truncation,
/// so that it includes what the motion has made of truncation and roundoff.
Solution solve_initial(const Problem& problem, const SolveOptions& options);

}  // namespace extremal
