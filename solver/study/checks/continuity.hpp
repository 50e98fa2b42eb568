#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file Whether L is continuous where it is not smooth.

namespace extremal {

/// Throws SceneError if L jumps across a surface where abs, min or max have their kinks, as x/abs(x) does:
/// its action would jump with the time of the crossing. Surfaces are tried at points about the guess.
void check_continuous(const Problem& problem, const SystemTable& system);

/// Whether first or second derivatives of L jump across such a surface, as with dry friction or a wall, but
/// not with quadratic drag. With forces these are those of both copies where they agree.
bool stiffness_jumps(const Problem& problem);

}  // namespace extremal
