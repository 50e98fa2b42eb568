#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file What can be told of a problem before it is solved.

namespace extremal {

/// Throws SceneError at `at` if the Lagrangian is not finite somewhere on the guess as it is moved onto the
/// ends, with the values there; of a Hamiltonian (`by_momenta`) also with the velocities. An end that the
/// boundary relation fixes wholly is not the guess's.
void check_guess_finite(const Problem& problem, const Location& at, bool by_momenta);

/// Whether it would not.
bool is_finite_on_guess(const Problem& problem);

/// Throws SceneError at `at` if an end that is fixed wholly cannot have the energy that closes the duration:
/// where L is convex in the velocities, E = q'·∂L/∂q' − L is least at rest, −L(q, 0).
void check_energy_at_ends(const Problem& problem, const Location& at);

/// Whether 'where' changes with what the relation leaves free of the ends, somewhere about the guess: else it
/// follows from them, or contradicts them.
bool where_determines(const Problem& problem);

/// Throws SceneError at `at` where the times of the nodes cannot be unknowns: all elements have one energy,
/// so L must not depend on t, and a free duration is closed by that energy.
void check_free_steps(const Problem& problem, const Location& at);

}  // namespace extremal
