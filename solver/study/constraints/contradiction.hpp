#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file Constraints and ends that no point satisfies.

namespace extremal {

/// Throws SceneError, with the amount, where a constraint contradicts the ones before it, or what is given at
/// an end: from all points near `points` that are tried, count × n, as near as it comes it is missed. Nothing
/// is proved far from them.
void check_contradictions(const Scene& scene, const Problem& problem, const std::vector<double>& points);

}  // namespace extremal
