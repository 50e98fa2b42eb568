#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/study.hpp"
#include "system/formula.hpp"

/// \file Inequalities along the path in a problem.

namespace extremal {

/// Throws SceneError for what a scene with [path] may not ask for. Does nothing without [path].
void check_inequalities(const Scene& scene, Purpose purpose);

/// Whether an unknown changes an inequality.
bool inequalities_vary(const Scene& scene);

/// Puts the inequalities of [path] into a problem that is complete but for them. Ends that are fixed must
/// keep them; those that miss them by decimals are moved. Throws SceneError, with the amount for an end.
/// Does nothing without [path].
void put_inequalities(const Scene& scene, const System& system, Problem& problem);

}  // namespace extremal
