#pragma once

#include "solution/solution.hpp"
#include "solve/branch/branch.hpp"

/// \file Orbits of half the period, run through twice, among those of a family.

namespace extremal {

/// The mean of the product of what orbits a and b differ from themselves half a period later. What an orbit
/// is compared with is turned by the relation of half the period; without one in the family, that is none
/// where orbits close without a turn. Nothing in a family of other paths.
std::optional<double> alternation(const ProblemFamily& family, double varied, const Trajectory& a,
                                  const Trajectory& b);

/// Whether an orbit repeats one of half the period, within `distance`.
bool has_half_period(const ProblemFamily& family, double varied, const Trajectory& path, double distance);

}  // namespace extremal
