#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"
#include "solve/contact/arcs.hpp"

/// \file Local minimisers of the action among the paths that keep inequalities.

namespace extremal {

/// A local minimiser near the guess. An interior point method finds on a coarse path where the inequalities
/// are equalities. Between these times the path is made of extremals: free ones, and such that are held. They
/// are solved to the tolerance by `solve`, and meet without a kink. The law is then checked between all
/// nodes: no point is forbidden, and the force of a contact is never negative; where it fails, contacts are
/// added or left out.
Solution solve_with_inequalities(const Problem& problem, const SolveOptions& options, const ArcSolve& solve);

/// Up to `most` different local minimisers, from the guess and from paths that pass on other sides, sorted by
/// action.
std::vector<Solution> minimisers(const Problem& problem, const SolveOptions& options, int most,
                                 const ArcSolve& solve);

}  // namespace extremal
