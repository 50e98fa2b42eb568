#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file Whether L is continuous where it is not smooth.

namespace extremal {

/// Throws SceneError if L jumps across a surface where abs, min or max have their kinks, as x/abs(x) does:
/// its action would jump with the time of the crossing. Surfaces are tried at points about the guess.
void check_continuous(const Problem& problem, const SystemTable& system);

/// Whether forces or momenta jump across such a surface, as dry friction does, not quadratic drag.
bool forces_jump(const Problem& problem);

}  // namespace extremal
