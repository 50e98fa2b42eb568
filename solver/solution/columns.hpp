#pragma once

#include <span>

#include "solution/solution.hpp"

/// \file Trajectories at many times, coordinate by coordinate.

namespace extremal {

/// q and q' at m times in [0, T]: coordinate a at time i goes to q[a][i] and v[a][i]. The same as
/// Trajectory::at() but for rounding, without a search where times ascend. Throws std::invalid_argument for
/// other times.
void evaluate_columns(const Trajectory& trajectory, std::span<const double> times, std::span<double* const> q,
                      std::span<double* const> v);

/// Canonical momenta p = ∂L/∂q' at m points in the same layout.
void momentum_columns(const Lagrangian& lagrangian, std::span<const double> times,
                      std::span<const double* const> q, std::span<const double* const> v,
                      std::span<double* const> p);

}  // namespace extremal
