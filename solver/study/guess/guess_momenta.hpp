#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "system/tape.hpp"

namespace extremal {

/// Sets the momenta that are not `given` (n entries) in the guess of a problem in phase space, whose samples
/// have some: those for which ∂H/∂p comes nearest to the velocities of the guess, and H to an energy that
/// closes the duration. Where ∂H/∂p does not depend on them they stay as they are.
void complete_momenta(const LagrangianGraph& hamiltonian, const std::vector<char>& given, Problem& problem);

}  // namespace extremal
