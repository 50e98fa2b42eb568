#pragma once

#include <Eigen/Core>
#include <vector>

#include "problem/manifold.hpp"
#include "system/chart.hpp"

/// \file Planes in which a constraint holds a path at a distance from a centre: there an angle is a
/// coordinate however far the path turns.
///
/// Where ∂²g/∂q² is constant, g = ½ Σ_i λ_i (v_i·(q − c))² + a linear function of other directions. Among
/// directions with λ_i of one sign the coordinates √|λ_i| v_i·(q − c) make g a function of their sum of
/// squares: rods have two such directions, spheres and ellipsoids three. Of other constraints, as of surfaces
/// of revolution, planes of two coordinates are tried.

namespace extremal {

/// Coordinates z of q = B z, some pairs of which are polar.
struct Frame {
  Eigen::MatrixXd basis;  ///< B
  std::vector<Polar> polar;
  bool spatial = false;  ///< the radius of a pair depends on other coordinates
};

/// Points of a path, in time.
struct PathPoints {
  std::vector<Eigen::VectorXd> q;
  std::vector<double> times;
};

/// Frames with as many polar pairs as constraints and the path allow; none where these have no planes. Where
/// a constraint has more than two directions, there is one for each plane of coordinates and one for the
/// plane that the path is nearest to.
std::vector<Frame> polar_frames(const Manifold& manifold, const PathPoints& path);

/// The constraints that rotations of a pair of z = B⁻¹ q about its centre leave as they are, near a path and
/// at all times.
std::vector<int> invariant_constraints(const Manifold& manifold, const PathPoints& path,
                                       const Eigen::MatrixXd& basis, const Polar& pair);

}  // namespace extremal
