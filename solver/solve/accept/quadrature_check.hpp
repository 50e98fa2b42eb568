#pragma once

#include <optional>

#include "solution/observe.hpp"
#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file A path under a finer quadrature, with other points and more of them: its forces may differ where the
/// points of the elements miss some, and it rounds otherwise.

namespace extremal {

struct QuadratureCheck {
  double moved = 0;      ///< q, absolute: to where the path is stationary under it, to first order
  double turned = 0;     ///< q' there, relative to the range of velocities
  double kicked = 0;     ///< momenta at its ends
  bool unlike = false;   ///< the residual of the whole orbit exceeds that of its part
  bool isolated = true;  ///< no null direction is left without a symmetry
  std::optional<double> softest = {};  ///< least_eigenvalue(), with the same factors

  /// Whether a path of the elements that the tolerance asked for is moved by more than that allows.
  bool missed(const SolveOptions& options, const Outcome& outcome) const;
  /// Whether momenta at the ends change by more than the tolerance allows.
  bool kicks(const SolveOptions& options) const;
};

/// Of a path off which `solution` was read, with the factors that the workspace's iteration has of it. The
/// action is then that of the finer quadrature. Nothing is known of a path at rest, or of one that could not
/// be factored.
QuadratureCheck check_quadrature(const Problem& problem, const Path& path, const Outcome& outcome,
                                 const Solution& solution, Workspace& workspace);

/// Of a path on the elements of the workspace's iteration. Along a whole orbit it is the same as along its
/// part, unless forces lack a symmetry that they had where they were compared.
double residual_under_finer(const Problem& problem, const Path& path, const Outcome& outcome,
                            Workspace& workspace);

/// Continues Newton's method with gradients in extended precision, then with factors of 106 bits, where the
/// finer quadrature moves a path: that may be roundoff. False if it fails, or if the system has none.
bool polish(Path& path, NewtonIteration& newton);

/// Raises the error estimate of a converged solution where the check shows a larger one, and refuses the
/// solution where it then misses the tolerance.
void judge_quadrature(const QuadratureCheck& check, const SolveOptions& options, const Outcome& outcome,
                      Solution& solution);

}  // namespace extremal
