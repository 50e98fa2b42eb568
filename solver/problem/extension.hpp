#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "system/end_condition.hpp"
#include "system/lagrangian.hpp"

/// \file What a problem may have beside its path, the linear relation of its ends and its duration: unknown
/// constants, integrals that are given, nonlinear conditions, and points in between.

namespace extremal {

class Manifold;

/// A condition that follows from constraints and other conditions, which is not imposed.
struct ImpliedCondition {
  EndCondition condition;
  std::string text;
};

/// A point in between: coordinates that are fixed at a time.
struct WaypointCondition {
  double time = 0;                            ///< in (0, T); where it is free, t/T of its guess
  bool free = false;                          ///< S is stationary in the time: the energy is continuous
  std::vector<std::pair<int, double>> fixed;  ///< coordinate, value
  /// The time, or its guess.
  double at(double duration) const { return free ? time * duration : time; }
};

/// Stationary points of
///
///   S + Σ_j ν_j (∫ g_j dt − c_j) + Σ_i η_i r_i(q(0), q(T), k) + Σ_l e_l(q(0), q(T), k)
///
/// in the path, in ν and in η; e are p(k)·q(0) and −p(k)·q(T), where momenta are given by constants. The
/// constants k are held there; the conditions w(q(0), q(T), k) = 0 determine them, and where no energy does,
/// a free duration.
///
/// The constants k and ν are coordinates of `lagrangian`, L + Σ ν_j g_j, behind the n of the path:
/// coordinates that are constant along the path and have no velocity. So all derivatives with respect to them
/// come from the same tape.
struct Extension {
  std::shared_ptr<const Lagrangian> lagrangian;  ///< of n + u + m coordinates: q, k, ν
  std::vector<std::string> names;                ///< of k, u entries
  std::vector<double> guess;                     ///< of k, u entries
  std::vector<double> integrals;                 ///< c, m entries
  std::vector<EndCondition> conditions;          ///< r, over the ends of all n + u + m coordinates
  std::vector<EndCondition> end_terms{};         ///< e, likewise
  std::vector<EndCondition> where;               ///< w, likewise
  std::vector<WaypointCondition> waypoints;      ///< in order of their times
  /// L + Σ ν_j g_j of n coordinates for given values of k and ν.
  std::function<std::shared_ptr<const Lagrangian>(const std::vector<double>& constants)> at;
  /// With constraints: their manifold for these values. Empty: there are none.
  std::function<std::shared_ptr<const Manifold>(const std::vector<double>& constants)> manifold_at{};
  std::vector<ImpliedCondition> implied{};  ///< over the ends of all coordinates
  /// With forces: the Lagrangian of both copies, of 2n + u coordinates q₁, q₂, k, and that for given values
  /// of k. Null and empty: there are none.
  std::shared_ptr<const Lagrangian> copies{};
  std::function<std::shared_ptr<const Lagrangian>(const std::vector<double>& constants)> copies_at{};

  int unknowns() const { return static_cast<int>(names.size()); }
  int multipliers() const { return static_cast<int>(integrals.size()); }
  int constants() const { return unknowns() + multipliers(); }
};

}  // namespace extremal
