#pragma once

#include <optional>

#include "solution/solution.hpp"
#include "system/lagrangian.hpp"

/// \file Forces that depend on time and act between the points of all elements.

namespace extremal {

/// The step of the times at which d/dt ∂L/∂q' = ∂L/∂q is far from true on a trajectory, though its elements
/// resolve it; absent where it is true at all of some thousand equal steps. Δp of a step is compared with the
/// step times ∂L/∂q in its middle.
std::optional<double> overlooked_force(const Lagrangian& lagrangian, const Trajectory& trajectory);

}  // namespace extremal
