#pragma once

#include "solve/search/guess_mesh.hpp"

/// \file From extremals of other durations, or of weaker forces, to those of the problem.

namespace extremal {

/// From durations in which the guess is nearly a motion, through extremals of all durations between.
Trial through_other_durations(Pursuit& pursuit, const GuessMesh& guess);

/// Steps kept for weaker forces; 0 where they are not tried.
int steps_for_weaker_forces(const Pursuit& pursuit);
/// From the extremal of a quadratic Lagrangian, through those of weaker nonlinear forces.
Trial through_weaker_forces(Pursuit& pursuit, const GuessMesh& guess);

}  // namespace extremal
