#pragma once

#include <span>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Points of a solution in phase space.

namespace extremal {

/// q, q' and the canonical momenta p = ∂L/∂q' at time t in [0, T], n entries each.
void phase_point(const Problem& problem, const Trajectory& trajectory, double t, std::span<double> q,
                 std::span<double> v, std::span<double> p, Scratch& scratch);

}  // namespace extremal
