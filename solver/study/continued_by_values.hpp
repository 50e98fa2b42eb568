#pragma once

#include <functional>

#include "study/continued.hpp"
#include "study/study.hpp"

/// \file Families of extremals with ends at infinity, or at which L is infinite, with constants, integrals,
/// conditions or waypoints, and of those of a scheme.

namespace extremal {

/// Whether a family of this problem is followed from value to value: so that each point satisfies the
/// discrete equations of a scheme, with its elements or to the tolerance.
bool continued_by_values(const Problem& problem, const SolveOptions& options);

/// Follows it, each extremal from the one before, by steps that are halved where Newton's method does not
/// lead from one to the next. Folds end such a branch; branch points on it are not looked for, nor period
/// doublings.
FollowedBranch follow_by_values(const Study& study, const Continued& continued,
                                const std::function<void(const BranchPoint&)>& progress);

}  // namespace extremal
