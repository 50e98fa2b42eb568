#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "solve/contact/coarse_action.hpp"

/// \file Values that are found with a path, as those of its problem: unknown constants and times of
/// waypoints.

namespace extremal {

/// The unknowns of the problem: their values.
std::vector<double> unknowns_of(const Problem& problem);
/// Unknowns get values, by which L, constraints and inequalities change.
void put_unknowns(const std::vector<double>& unknowns, Problem& problem);
/// Free times of waypoints become those of the nodes of a path.
void put_free_times(const std::vector<WaypointNode>& free, const std::vector<double>& times,
                    Problem& problem);

}  // namespace extremal
