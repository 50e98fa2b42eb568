#pragma once

#include <memory>
#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"
#include "scene/scene.hpp"

/// \file Integrals and conditions that follow from each other, or contradict each other, by their formulas.

namespace extremal {

/// `integrands` are the left sides of the integrals as Lagrangians. Throws SceneError where one is a sum of
/// multiples of those before it at all points tried.
void check_independent_integrals(const std::vector<Text>& texts, const Problem& problem,
                                 const std::vector<std::shared_ptr<const Lagrangian>>& integrands);

/// Throws SceneError where the gradient of a condition along the ends that the relation leaves free is made
/// of those before it at all points tried.
void check_independent_conditions(const std::vector<Text>& texts, const Problem& problem,
                                  const Extension& extension);

}  // namespace extremal
