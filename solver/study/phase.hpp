#pragma once

#include <span>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Points of a solution in phase space.

namespace extremal {

/// Names of the coordinates, in phase space without momenta.
std::vector<std::string> coordinate_names(const Problem& problem);

/// q, q' and the canonical momenta p = ∂L/∂q' at time t in [0, T], an entry for each degree of freedom.
void phase_point(const Problem& problem, const Trajectory& trajectory, double t, std::span<double> q,
                 std::span<double> v, std::span<double> p, Scratch& scratch);

/// The same at m times, a column for each coordinate: that of a at q[a], v[a], p[a], m entries each. Where no
/// momenta are wanted, p is empty.
void phase_columns(const Problem& problem, const Trajectory& trajectory, std::span<const double> times,
                   std::span<double* const> q, std::span<double* const> v, std::span<double* const> p);

/// λ of d/dt ∂L/∂q' − ∂L/∂q = Σ λ_k ∂g_k/∂q at such a point, one for each constraint g_k = 0.
std::vector<double> constraint_forces(const Problem& problem, std::span<const double> q,
                                      std::span<const double> v, double t);

}  // namespace extremal
