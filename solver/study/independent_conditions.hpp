#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/extension.hpp"

/// \file Integrals, conditions and unknowns that formulas leave undetermined.

namespace extremal {

/// Throws SceneError where an integral or a condition follows from what else is given, or contradicts it, and
/// where the equations do not contain an unknown, or contain it in one combination with others alone: on all
/// paths tried about the guess.
void check_determined(const Scene& scene, const ExtendedScene& parts, const Problem& problem);

}  // namespace extremal
