#pragma once

#include <cstddef>
#include <optional>

#include "solve/adapt/options.hpp"
#include "study/continued.hpp"

/// \file Families of constrained problems in minimal coordinates.

namespace extremal {

/// The branch that a study asks for, followed in the coordinates of its problem's chart. Nothing where it has
/// none, or where it does not have a point of the branch to the tolerance.
std::optional<FollowedBranch> follow_in_minimal_coordinates(const Study& study, const SolveOptions& options);

/// How many branches end without a reason that all coordinates share: those may lead on from the chart.
std::ptrdiff_t unended(const FollowedBranch& followed);

}  // namespace extremal
