#pragma once

#include <optional>
#include <vector>

#include "solve/contact/coarse_action.hpp"

/// \file Paths from which a minimum under inequalities is looked for.

namespace extremal {

/// The guess, or the line between the ends, at the nodes of a coarse path; nodes where an inequality does not
/// hold are moved to where it does. Where that makes the path jump, as past the middle of an obstacle, it is
/// bent aside first, the less the better.
std::vector<double> first_path(const Problem& problem, const CoarseAction& action);

/// Nodes of a first path. Where it is pulled tight, nearly the action of the minimum that it leads to.
struct FirstPath {
  std::vector<double> nodes;
  std::optional<double> action = {};
  double moved = 0;  ///< from the guess, the sum over the nodes
};

/// The same past each obstacle on one side or the other, pulled tight: those of least action first, then
/// those that could not be pulled, by how far they move. Sides are those of one direction across the path; an
/// obstacle beside the path may also be between it and where it was.
std::vector<FirstPath> paths_by_sides(const Problem& problem, const CoarseAction& action);

/// The same bent by waves, for the `number`-th start of a search; nothing if it jumps.
std::optional<std::vector<double>> bent_path(const Problem& problem, const CoarseAction& action, int number);

/// Starts of a search that differ.
int bent_paths(const Problem& problem);

}  // namespace extremal
