#pragma once

#include "analysis/variation.hpp"
#include "solve/adapt/workspace.hpp"

/// \file From the path where a solve ended to what is returned.

namespace extremal {

/// Eigenvalues of the second variation so small, relative to those of one element, or smaller count in the
/// nullity: the error of the discretisation, taken to be that of a trajectory of this size. What ends feel is
/// by the number of elements less than what each adds and takes.
double null_threshold(double error, double size, int elements);

/// What the path in the workspace is worth: momenta, index, energy, windows; or why there is no extremal.
/// Its history and the time until it was found are the caller's. `variation` is kept between solves.
Solution finish(const Problem& problem, const SolveOptions& options, const Outcome& outcome,
                Workspace& workspace, SecondVariation& variation);

}  // namespace extremal
