#pragma once

#include <vector>

#include "solution/solution.hpp"
#include "system/lagrangian.hpp"

/// \file Forces that act between the points of long elements, as pulses in time or space do.

namespace extremal {

/// Steps of a trajectory, of equal length, over which d/dt ∂L/∂q' = ∂L/∂q is far from true, though they lie
/// in elements that resolve it.
struct OverlookedForces {
  double step = 0;              ///< the length
  std::vector<int> steps = {};  ///< their numbers, ascending
};

/// Looks for them over some thousand steps: Δp of a step is compared with the step times ∂L/∂q in its middle.
/// Elements of a few steps overlook nothing.
OverlookedForces overlooked_forces(const Lagrangian& lagrangian, const Trajectory& trajectory);

}  // namespace extremal
