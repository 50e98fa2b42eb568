#pragma once

#include <optional>
#include <string>

#include "action/corners.hpp"
#include "problem/problem.hpp"

/// \file Kinks in velocities that no extremal crosses smoothly.

namespace extremal {

/// Where a path crosses a surface u(q, q', t) = 0 and the part w |u| of L makes the momentum jump there, by
/// 2 w ∂u/∂q'. The velocity of an extremal would stay on the surface for a while, or jump across it: so the
/// path is none.
struct MomentumJump {
  double time = 0;
  double size = 0;  ///< the largest of a coordinate
};
/// The first one.
std::optional<MomentumJump> momentum_jump(const Problem& problem, const Polynomials& path);
std::optional<MomentumJump> momentum_jump(const Problem& problem, const Path& path);
std::string describe(const MomentumJump& jump);

}  // namespace extremal
