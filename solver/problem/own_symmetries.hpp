#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "problem/symmetry.hpp"

/// \file The continuous symmetries that move extremals of a problem to others.

namespace extremal {

/// About its guess, by what kind of problem it is: of closed paths, in phase space by the Lagrangian without
/// squares; of those from equilibrium to equilibrium; of two copies, of one at a time. None of other
/// problems.
std::vector<Generator> own_symmetries(const Problem& problem, const SymmetrySearch& search = {});

}  // namespace extremal
