#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file Whether momenta and velocities determine each other, at points about the guess.

namespace extremal {

/// Whether ∂²L/∂q'∂q' of a Lagrangian is regular at a point near the guess. True where it is finite nowhere,
/// or of too many coordinates.
bool is_regular(const Problem& problem);

/// Throws SceneError if a Lagrangian is not regular: the velocities do not follow from the momenta.
void check_regular(const Problem& problem, const SystemTable& system);

/// Whether the momenta of a Hamiltonian follow from the velocities near the guess: ∂²H/∂p∂p is regular, and
/// its eigenvalues do not change their signs.
bool has_legendre_transform(const Problem& problem);

}  // namespace extremal
