#pragma once

#include <optional>
#include <string>

#include "problem/closing.hpp"
#include "solution/solution.hpp"

/// \file Corners between elements, which a stationary point of a discrete action may have where L is not
/// convex in the velocities.
///
/// The discrete equations make p = ∂L/∂q' continuous at a node, the corner condition of Weierstrass and
/// Erdmann; the other one, that p·q' − L is continuous, holds only if the time of the corner is varied too.
/// Let v₋ and v₊ be the velocities on both sides of a node, p₋ and p₊ their momenta. By the trapezoid rule
/// for p along the segment from v₋ to v₊,
///   L(v₊) − L(v₋) − ½(p₋ + p₊)·(v₊ − v₋)
/// is the jump of the energy less that which goes with the jump of p. Where L is convex or concave on the
/// segment it is no larger than ½(p₊ − p₋)·(v₊ − v₋). Beyond that bound the path has a corner there.

namespace extremal {

struct BrokenNode {
  double time = 0;
  double velocity = 0;  ///< the largest jump of a coordinate's velocity
  double energy = 0;    ///< the jump of p·q' − L
};

/// Of the nodes between the elements first, …, last − 1, the broken one with the largest jump of the energy.
/// `paired`: of two copies of the coordinates (system/copies.hpp), along a path on which they agree.
/// None where p is linear in q'. `closing`: of a closed path, whose last node is one between elements too;
/// else null.
std::optional<BrokenNode> find_broken_node(const Lagrangian& lagrangian, const Trajectory& trajectory,
                                           bool paired, int first, int last,
                                           const ClosingMap* closing = nullptr);
std::optional<BrokenNode> find_broken_node(const Lagrangian& lagrangian, const Trajectory& trajectory,
                                           bool paired);

/// Why a path that has it is no extremal.
std::string describe(const BrokenNode& node);

}  // namespace extremal
