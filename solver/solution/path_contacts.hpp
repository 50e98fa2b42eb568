#pragma once

#include <memory>
#include <span>
#include <vector>

/// \file Where a path touches what inequalities forbid.

namespace extremal {

class Manifold;

/// From one time to another an inequality is an equality.
struct Contact {
  int constraint = 0;
  double from = 0, to = 0;
};

/// Of a problem with inequalities along the path.
struct PathContacts {
  /// A part of the path on which the same inequalities are equalities.
  struct Arc {
    double from = 0, to = 0;
    std::vector<int> held;  ///< ascending
    /// Of the constraints of the problem, then of those, in their order; null where none of them is held.
    std::shared_ptr<const Manifold> manifold;
  };
  int constraints = 0;
  std::vector<Contact> contacts;  ///< by their beginnings
  std::vector<Arc> arcs;          ///< abutting, from 0 to T

  /// The arc at t; between two of them the later one.
  const Arc& at(double t) const;
  /// μ_k >= 0 of ∂L/∂q − d/dt ∂L/∂q' = Σ μ_k ∂g_k/∂q at t, one for each inequality: δS = ∫ Σ μ_k δg_k dt.
  std::vector<double> forces(std::span<const double> q, std::span<const double> v, double t) const;
  /// λ of the constraints of the problem where an inequality is an equality at t; nothing elsewhere.
  std::vector<double> constraint_forces(std::span<const double> q, std::span<const double> v, double t) const;
};

}  // namespace extremal
