#pragma once

#include <span>

#include "problem/symmetry.hpp"
#include "solution/solution.hpp"

/// \file Symmetries that move a path.

namespace extremal {

/// Of a path that symmetries move to others with the same ends.
inline constexpr char family_of_symmetries[] =
    "; this is one of a family of extremals, which symmetries of the problem make of it";

/// In how many independent directions symmetries move a path. If `but_along_itself`, the direction of its
/// velocity does not count: a rotation of a circular orbit is a shift in time.
int moving_symmetries(std::span<const Generator> symmetries, const Trajectory& path, bool but_along_itself);

}  // namespace extremal
