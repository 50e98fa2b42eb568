#pragma once

#include "analysis/variation.hpp"
#include "solve/adapt/options.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Fixed ends that are conjugate, or nearly so: then a Jacobi field that vanishes at both costs
/// nothing, or little, and the extremal is not unique, does not exist, or is known no better than the
/// equations divided by the distance from a conjugate time.

namespace extremal {

/// For a converged solution, a path on elements of `tables` whose T is at `distance` from a time conjugate to
/// 0. Where that is within its error, or where the error that results exceeds the tolerance, status and
/// message say so; otherwise error_estimate includes it. Does nothing unless both ends and the duration are
/// fixed.
void judge_conjugate_ends(const Problem& problem, const SolveOptions& options, const Path& path,
                          const ElementTables& tables, double distance, Workspace& workspace,
                          Solution& solution);

/// Whether conjugate ends may be why no solution was found: whether they are on the last path that was tried.
bool failed_at_conjugate_ends(const Problem& problem, const Trajectory& last, SecondVariation& memory);

}  // namespace extremal
