#pragma once

#include <vector>

#include "solve/adapt/options.hpp"
#include "solve/branch/branch_point.hpp"

/// \file The branches that begin at a branch point.

namespace extremal {

/// The first state on a branch, its tangent onward.
struct FirstState {
  BranchState state;
  bool regular = false;  ///< see Branch
};

/// The branches that begin at a branch point, but for the known one: in directions that the bifurcation
/// equations give, to states that Newton's method finds. A branch goes two ways from the point; of others
/// that a symmetry maps onto each other one is kept.
struct OtherBranches {
  std::vector<FirstState> found = {};
  bool complete = false;  ///< a branch was found in each of the directions
};

/// The family is that of the orbits that begin: after a period doubling, that of twice the period, whose two
/// ways are the same orbits.
OtherBranches other_branches(const ProblemFamily& family, const SolveOptions& options,
                             const BranchStart& start);

}  // namespace extremal
