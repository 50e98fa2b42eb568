#pragma once

#include <optional>

#include "solve/adapt/options.hpp"
#include "study/continued.hpp"

/// \file Families of constrained problems in minimal coordinates.

namespace extremal {

/// The branch that a study asks for, followed in the coordinates of its problem's chart. Nothing where it has
/// none, or where the branch may leave the chart before it ends.
std::optional<FollowedBranch> follow_in_minimal_coordinates(const Study& study, const SolveOptions& options);

}  // namespace extremal
