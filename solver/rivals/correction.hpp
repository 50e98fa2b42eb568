#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "rivals/conditions.hpp"

/// \file How far a chain of pieces of motion is from one motion that meets the end conditions.

namespace extremal {

/// q in between: how it spreads from the state at the start of its piece (n × 2n), and its defect.
struct Waypoint {
  Eigen::MatrixXd transition;
  Eigen::VectorXd defect;
};

/// A piece from x_k to x_{k+1}, all in units of the scales (q, p).
struct MotionPiece {
  double start = 0, end = 0;
  Eigen::MatrixXd transition;   ///< ∂(state at the end)/∂(state at the start), 2n × 2n
  Eigen::VectorXd defect;       ///< state at the end, integrated, less x_{k+1}
  Eigen::VectorXd by_duration;  ///< of that state, times stretched with the duration; empty where it is fixed
  std::vector<Waypoint> waypoints;  ///< in between
};

/// One step of multiple shooting: the changes δx_0 … δx_m, 2n each, with
///   transition_k δx_k − δx_{k+1} + by_duration_k δT = −defect_k,   derivatives · (δx_0, δx_m) = −residual.
/// Directions that these leave all but free, as symmetries do, are not moved along. Empty where that cannot
/// be computed.
Eigen::VectorXd correction(const std::vector<MotionPiece>& pieces, const EndConditions::Values& conditions,
                           const PhaseScales& scales);

/// Largest change of q that a correction makes, at the ends of pieces and at their waypoints. (Waypoints see
/// a change of the duration only through those ends.)
double largest_change(const std::vector<MotionPiece>& pieces, const Eigen::VectorXd& correction);

/// Has the sign of det ∂q(T)/∂p(0), with L_vv positive definite (−1)^k for k conjugate times in (0, T); its
/// modulus is the least variation of q among those of q and p together, which errors may turn round.
double orientation(const std::vector<MotionPiece>& pieces);

}  // namespace extremal
