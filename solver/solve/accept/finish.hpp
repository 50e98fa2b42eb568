#pragma once

#include "analysis/variation.hpp"
#include "solve/adapt/workspace.hpp"

/// \file From the path where a solve ended to what is returned.

namespace extremal {

/// What the path in the workspace is worth: momenta, index, energy, windows; or why there is no extremal.
/// Its history and the time until it was found are the caller's. `variation` is kept between solves.
Solution finish(const Problem& problem, const SolveOptions& options, const Outcome& outcome,
                Workspace& workspace, SecondVariation& variation);

}  // namespace extremal
