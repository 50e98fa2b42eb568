#pragma once

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Whether a path is known along the direction in which the second variation is softest. Between two
/// rests, at equilibria or along limit cycles, hardly a force holds it in time: elements hold it anywhere.

namespace extremal {

/// Whether a path may err by as much as changes the sign of the least eigenvalue.
bool soft(const Problem& problem, const Outcome& outcome, const Path& path, double eigenvalue, double error);

/// Refuses a path that is soft unless Newton's method on finer elements converges to the same, and the second
/// variation is the same there. What it moves is a part of the error.
void judge_isolation(const Problem& problem, const Path& path, const Outcome& outcome, double eigenvalue,
                     Workspace& w, Solution& solution);

}  // namespace extremal
