#pragma once

#include "solution/solution.hpp"

/// \file Solutions with constraints, which are found with the Lagrangian L̃ of system/constraints.hpp.

namespace extremal {

/// A converged solution for L̃ whose nodes are off the manifold by more than its error is refused.
void check_on_manifold(const Problem& problem, Solution& solution);

/// Leaves out of the multipliers of a closed path those of what is beside the manifold.
void leave_out_normal(const Problem& problem, const Trajectory& trajectory, Floquet& floquet);

/// Of a problem with constraints, given its solution for L̃: nodes are moved onto the manifold, where they
/// are but for truncation, momenta become those of L, multipliers of what is beside the manifold are left
/// out. A path that is not on the manifold within its error is no solution.
void move_onto_manifold(const Problem& problem, Solution& solution);

}  // namespace extremal
