#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solution/solution.hpp"

/// \file What is read off along a trajectory: energy, momenta and their ranges.

namespace extremal {

/// Over every node of every element and the midpoints between them, each element with its own polynomial.
struct Survey {
  bool finite = true;           ///< the energy was finite everywhere
  double energy = 0;            ///< p·q' − L at t = 0
  double energy_drift = 0;      ///< largest |E(t) − E(0)|
  std::vector<double> q, v, p;  ///< range (max − min) of each coordinate, velocity, canonical momentum
  /// Largest sums over coordinates of |q'|, of the terms of p and, between the ends, where a layer that no
  /// point sees may begin, of |∂L/∂q|; and of the terms of p·q' and |L|, which energy is left of.
  double speed = 0, momentum = 0, force = 0, terms = 0;
};

/// Throws std::invalid_argument if the two differ in their coordinates.
Survey survey(const Lagrangian& lagrangian, const Trajectory& trajectory);

/// A survey whose terms include M q' and q'ᵀM q', M = ∂²L/∂q'² at q' = 0, at the nodes of the mesh and
/// between them. L may form all terms of p as one: where they cancel, as along a drift, their roundoff is
/// that of these.
Survey with_inertia(Survey found, const Lagrangian& lagrangian, const Trajectory& trajectory);

/// Sets energy and drift of a solution, from the survey that is returned; leaves all absent where L depends
/// on t or the energy is not finite.
std::optional<Survey> observe_energy(const Lagrangian& lagrangian, Solution& solution);

/// The discrete energy −∂L_d/∂h of each element (Chen-Guo-Wu (3.3)): p·q' − L summed by the quadrature on [0,
/// 1] that the elements were solved with. Empty where L depends on t, and beyond most_energies elements.
std::vector<double> element_energies(const Lagrangian& lagrangian, std::span<const double> nodes,
                                     std::span<const double> weights, const Trajectory& trajectory);
inline constexpr int most_energies = 100'000;

}  // namespace extremal
