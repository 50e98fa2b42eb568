#pragma once

#include <optional>

#include "solution/observe.hpp"
#include "solve/adapt/workspace.hpp"

/// \file A path that was found, under a quadrature with other points and more: they see forces that the
/// points of its elements may not, and round otherwise.

namespace extremal {

struct OtherPoints {
  double moved = 0;        ///< q, absolute: to where the path is stationary under them, to first order
  double turned = 0;       ///< q' there, relative to the range of velocities
  double kicked = 0;       ///< momenta at its ends
  bool unlike = false;     ///< they see more on the whole orbit than on its part
  bool told_apart = true;  ///< from the paths beside it

  /// Whether a path of the elements that the tolerance asked for is moved by more than that allows.
  bool missed(const SolveOptions& options, const Outcome& outcome) const;
};

/// `solution` holds what was read off the path in the workspace, whose iteration factored it last; the action
/// is then the one under other points. Nothing is told of a path at rest, or of one that could not be
/// factored.
OtherPoints try_other_points(const Problem& problem, const Outcome& outcome, const Solution& solution,
                             Workspace& workspace);

/// Of the path under them, on whose elements the workspace's iteration is. Along a whole orbit it is what it
/// is along its part, unless forces that looked symmetric where they were compared are not.
double residual_under_others(const Problem& problem, const Outcome& outcome, Workspace& workspace);

/// Ends Newton's method at a path that other points move, with gradients in extended precision: what moved it
/// may be roundoff. False if that cannot be done, or was.
bool polish(Workspace& workspace);

/// Raises the error estimate of a converged solution where others tell a larger one, and refuses what misses
/// the tolerance by them.
void judge_by_other_points(const OtherPoints& others, const SolveOptions& options, const Outcome& outcome,
                           Solution& solution);

}  // namespace extremal
