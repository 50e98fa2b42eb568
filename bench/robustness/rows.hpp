#pragma once

#include <functional>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Random boundary problems that have a solution: the ends of trajectories integrated from random
/// states, all from fixed seeds.

namespace bench {

struct Case {
  extremal::Problem problem;
  /// Whether a solution is the one that was asked for; empty where any will do.
  std::function<bool(const extremal::Trajectory&)> intended = {};
};

/// Cases that differ in their numbers alone.
struct Row {
  std::string title;    ///< "pendulum, T = 20"
  std::string from;     ///< what the guess is
  double baseline = 0;  ///< percent that damped Newton on a fixed mesh finds; below 0: not known
  double wanted = 0;    ///< percent
  std::function<std::vector<Case>()> cases;
};

std::vector<Row> all_rows();

}  // namespace bench
