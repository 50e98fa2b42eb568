#pragma once

#include "solve/branch/branch.hpp"

/// \file The symmetries of a family.

namespace extremal {

/// The part of the way to the value wanted at which a member beside the first is looked at.
inline constexpr double beside_first = 1e-3;

/// The family with members that have the symmetries of all but single ones, which L has everywhere. The first
/// member, its problem, keeps those that it alone has, be it only in its place.
ProblemFamily with_common_symmetries(ProblemFamily family);

/// The same members with the symmetries of the first.
ProblemFamily with_symmetries_of_first(ProblemFamily family);

}  // namespace extremal
