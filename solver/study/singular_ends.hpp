#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/study.hpp"

/// \file Ends at which L is infinite.

namespace extremal {

/// Throws SceneError for what a scene may not ask for where L is infinite at an end, with a place beside it
/// from which it may. Does nothing where L is finite.
void check_singular_ends(const Scene& scene, Purpose purpose, const Problem& problem);

}  // namespace extremal
