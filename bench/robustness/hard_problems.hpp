#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solution/solution.hpp"

/// \file Problems at which methods fail: thin layers, long intervals, infinite ends, close encounters.

namespace bench {

struct HardProblem {
  std::string title, scene;            ///< its file, from the project's folder
  std::vector<std::string> sets = {};  ///< changes "key=value" to the scene
  std::optional<double> action = {};   ///< exact; of a search, of each solution
  std::vector<double> energies = {};   ///< of all solutions of a search, instead
  int wanted = 1;                      ///< solutions
  std::vector<std::string> peer = {};  ///< further changes with which the scene is given to others
  bool for_peer = true;                ///< whether a method for fixed intervals has a counterpart of it
  extremal::Status expected = extremal::Status::converged;
};

struct HardGroup {
  std::string title;
  std::vector<HardProblem> problems;
};

std::vector<HardGroup> hard_problems();

}  // namespace bench
