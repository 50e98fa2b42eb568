#pragma once

#include <memory>
#include <span>
#include <vector>

#include "motion/mass.hpp"
#include "motion/point.hpp"

/// \file The motion of a Lagrangian system as a flow in (q, p), p = ∂L/∂q'.

namespace extremal {

/// Velocities from which searches begin: |q'| has no derivative at rest.
inline constexpr double nearly_at_rest = 1e-6;

/// q' from ∂L/∂q'(q, q', t) = p, and p' = ∂L/∂q. Holds for every regular L and needs no derivative in t. The
/// variations follow from the second derivatives of L:
///   L_vv δq' = δp − L_vq δq,   δp' = L_qq δq + L_vqᵀ δq'.
/// With forces F, p' = ∂L/∂q + F: then `lagrangian` is that of two copies of the coordinates, and
/// copies = 2, see PointEvaluator.
class Flow {
 public:
  /// Not where constant inertia is singular: then there is no such flow.
  static bool suits(const Lagrangian& lagrangian, int copies = 1);
  /// `lagrangian` must outlive it. Throws std::invalid_argument where it does not suit.
  explicit Flow(const Lagrangian& lagrangian, int copies = 1);

  int coordinates() const { return n_; }

  /// p at (q, v, t); the search for q' begins from this v. False if L is not finite there.
  bool momentum(std::span<const double> q, std::span<const double> v, double t, std::span<double> p);
  /// q' that belongs to p. False if none is found.
  bool velocity(std::span<const double> q, std::span<const double> p, double t, std::span<double> v);

  /// (q, p)' for y = (q, p).
  bool slope(double t, std::span<const double> y, std::span<double> slope);
  /// The same with variations: y = (q, p) and then for each column (δq, δp).
  bool slope_with_variations(double t, std::span<const double> y, std::span<double> slope);

 private:
  bool motion(double t, std::span<const double> y, std::span<double> slope, Order order);
  bool solve_velocity(std::span<const double> q, std::span<const double> p, double t, Order order);
  bool solve_linear(std::span<const double> q, std::span<const double> p, double t, Order order);
  bool begin_along(std::span<const double> q, std::span<const double> p, double t);
  bool solve_newton(std::span<const double> q, std::span<const double> p, double t);
  double momentum_error(std::span<const double> q, std::span<const double> p, double t);

  int n_;
  const Structure& structure_;
  PointEvaluator point_;
  std::unique_ptr<PointEvaluator> hamiltonian_;  ///< where L is made of it: q' = ∂H/∂p
  MassMatrix mass_;
  std::vector<double> v_, last_v_, residual_, from_, step_;
};

}  // namespace extremal
