#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "solve/branch/diagram.hpp"
#include "system/constraints.hpp"
#include "system/formula.hpp"

/// \file [continuation]: a scene's family of problems, and the branch of its extremals.

namespace extremal {

struct Study;

/// A problem on a manifold whose Lagrangian is that of the system, and both as expressions.
struct BareProblem {
  Problem problem;
  ConstrainedGraph graph;
};

/// What a scene asks to be varied.
struct Continued {
  std::string parameter;   ///< its name; "duration" or "energy"
  ProblemFamily family;    ///< of the scene's problem
  int points = 50;         ///< at most, of each branch
  bool switching = false;  ///< also what bifurcates
  /// With constraints, for a parameter: the problem with this value of it, if there is one.
  std::function<std::optional<BareProblem>(double)> bare = {};
};

/// Throws SceneError for a parameter that is not there, or cannot be varied, and for a value that it has
/// already.
Continued read_continued(const Scene& scene, const System& system, const Problem& problem);

/// A branch as it was followed, with those that bifurcate from it if they were asked for.
struct FollowedBranch {
  std::string title;  ///< may be empty
  std::string parameter;
  std::vector<std::string> names;      ///< of the coordinates
  std::vector<BranchPoint> points;     ///< branch by branch
  std::vector<BranchRecord> branches;  ///< the first is the one that was asked for
};

/// Follows the branch that a scene asks for; `progress` is called with each point. Throws
/// std::invalid_argument if it asks for none.
FollowedBranch follow(const Study& study, const std::function<void(const BranchPoint&)>& progress = {});

}  // namespace extremal
