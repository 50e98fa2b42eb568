#pragma once

#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/constraints/constraints.hpp"
#include "system/moved_ends.hpp"

/// \file Unknown constants, integrals, nonlinear conditions and waypoints under holonomic constraints.
///
/// All of them are formulas of points of the manifold, P(x, t) of system/constraints.hpp: integrands join L
/// before it is projected, and conditions are those of P at the ends. So the natural conditions of ends have
/// no part normal to the manifold, whatever is given there.

namespace extremal {

/// Conditions of a problem with constraints, and which of them are imposed.
class ConditionsOnManifold {
 public:
  /// `host` is the system with the constants as coordinates; `manifold` that of the problem.
  ConditionsOnManifold(const ConstrainedGraph& host, const Manifold& manifold, double duration);

  const MovedEnds& ends() const { return ends_; }

  /// `relation` is the linear relation, which becomes conditions as well where `whole` holds: of an end that
  /// is fixed in part, or of constraints that unknowns change, it would ask for forces normal to the
  /// manifold. Then conditions that follow from the others and from the constraints near the guess are moved
  /// to `extension.implied`, and the relation becomes empty.
  void put_relation(const std::vector<std::string>& texts, Problem& problem, Extension& extension) const;

 private:
  MovedEnds ends_;
};

/// Fixes the coordinates that constraints determine at waypoints too. Throws SceneError where a point does
/// not satisfy the constraints, with the amount, or is fixed in part.
void complete_waypoints(const Scene& scene, const Problem& problem,
                        std::vector<WaypointCondition>& waypoints);

}  // namespace extremal
