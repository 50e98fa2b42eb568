#pragma once

#include <string>

#include "scene/scene.hpp"
#include "solve/continuation.hpp"
#include "system/formula.hpp"

/// \file [continuation]: a scene's family of problems, and the branch of its extremals.

namespace extremal {

struct Study;

/// What a scene asks to be varied.
struct Continued {
  std::string parameter;  ///< its name; "duration" or "energy"
  ProblemFamily family;   ///< of the scene's problem
  int points = 50;        ///< at most
};

/// Throws SceneError for a parameter that is not there, or cannot be varied, and for a value that it has
/// already.
Continued read_continued(const Scene& scene, const System& system, const Problem& problem);

/// A branch as it was followed.
struct FollowedBranch {
  std::string title;  ///< may be empty
  std::string parameter;
  std::vector<std::string> names;  ///< of the coordinates
  std::vector<BranchPoint> points;
  BranchEnd end = BranchEnd::not_started;
  std::string message = "nothing has been followed";  ///< why it ended
  double worst_action_slope = 0;                      ///< as Continuation::worst_action_slope()
};

/// Follows the branch that a scene asks for; `progress` is called with each point. Throws SceneError if it
/// asks for none.
FollowedBranch follow(const Study& study, const std::function<void(const BranchPoint&)>& progress = {});

}  // namespace extremal
