#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "problem/end_cost.hpp"
#include "system/lagrangian.hpp"

/// \file An equilibrium of L and the linearised motion about it.

namespace extremal {

/// The point q, q' = 0 at which ∂L/∂q = 0 at time t, and the linear equations of motion there, with the
/// coefficients that they have at t.
struct RestPoint {
  std::vector<double> q, momentum;  ///< and ∂L/∂q' there, n each
  double force = 0;                 ///< largest |∂L/∂q| at the point that was given
  double distance = 0;              ///< largest |q − given|; infinite where no equilibrium is near
  double value = 0;                 ///< L
  double stiffness = 0;             ///< largest |∂²L/∂q∂q|
  Eigen::VectorXcd exponents;       ///< 2n, of the linear motions e^{λt}
  double slowest = 0;               ///< least |Re λ|
  double slowest_in = 0;            ///< the same of motions to the equilibrium
  double slowest_out = 0;           ///< and of those from it
  bool hyperbolic = false;          ///< no λ is imaginary or zero
  /// p − ∂L/∂q' = S (q − q*) on motions that tend to the equilibrium as t → ∞ and as t → −∞, n × n; empty
  /// where these motions do not have one momentum for each q.
  Eigen::MatrixXd stable, unstable;
  /// Slowest decay towards an end at infinity, or away from a start.
  double decay(bool at_end) const { return at_end ? slowest_in : slowest_out; }
};

/// (η, π)' = A (η, π) for small deviations η of q and π of ∂L/∂q' from a point at rest where L has these
/// values: L = ½ η'ᵀMη' + η'ᵀCη + ½ ηᵀKη and π = Mη' + Cη. 2n × 2n.
Eigen::MatrixXd linear_motion(const PointValues& values, Eigen::Index n);

/// Beside the point that is given. Throws std::invalid_argument where L has no finite derivatives there.
RestPoint rest_point(const Lagrangian& lagrangian, std::span<const double> near, double t);

/// Exponents of the motions e^{λt} beside an equilibrium. With `two_copies` L is that of two copies of the
/// coordinates (system/copies.hpp), and they are those of one copy with its forces. NaN where masses are
/// singular and not zero.
Eigen::VectorXcd exponents_of_motion(const Lagrangian& lagrangian, std::span<const double> q,
                                     bool two_copies);

/// Least |Re λ| of the linear equations at a point that need be no equilibrium.
double slowest_rate(const Lagrangian& lagrangian, std::span<const double> q, double t);

/// The action, less that of rest, of the linear motion from q at the end of the path to the equilibrium, or
/// of that from the equilibrium to q at its start. Exact to the third order of q − q*.
EndCost cost_to(const RestPoint& rest, bool at_end);

/// "1.5, -1.5, 0.3 ± 2i".
std::string exponents_text(const RestPoint& rest);

}  // namespace extremal
