#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "system/tape.hpp"

namespace extremal {

/// What a guess in phase space knows of a coordinate.
enum class GuessKnows : char { velocity, momentum, both };

/// Sets the momenta that are not known (`known`: n entries) in the guess of a problem in phase space, whose
/// samples have some: those for which ∂H/∂p comes nearest to the velocities that are known, and H to an
/// energy that closes the duration. Where ∂H/∂p does not depend on them they stay as they are.
void complete_momenta(const LagrangianGraph& hamiltonian, const std::vector<GuessKnows>& known,
                      Problem& problem);

}  // namespace extremal
