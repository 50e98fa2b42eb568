#pragma once

#include <span>
#include <string>
#include <vector>

#include "system/constraints.hpp"
#include "system/end_condition.hpp"

/// \file Conditions between the ends of a path under constraints: of the points P of the manifold that stand
/// for the ends x of a path beside it (system/constraints.hpp). So the momenta that they ask for have no part
/// normal to the manifold.

namespace extremal {

/// P of both ends over the end values x(0), x(T): of the start, N expressions, then of the end.
struct MovedEnds {
  Graph graph;
  std::vector<NodeId> values;
};
MovedEnds moved_ends(ConstrainedGraph system, const NormalMotion& normal, double duration);

/// An equation "left = right" as end_condition() takes it, of the points P.
EndCondition condition_of_points(const std::string& text, const Vocabulary& vocabulary,
                                 const std::string& where, const MovedEnds& ends);

/// Σ coefficient·P_e = value; the columns of `row` number end values e.
EndCondition linear_condition_of_points(std::span<const Triplet> row, double value, const MovedEnds& ends);

}  // namespace extremal
