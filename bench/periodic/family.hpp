#pragma once

#include <optional>
#include <string>

#include "study/study.hpp"

/// \file What the points of a family of orbits cost.

namespace bench {

struct FamilyCost {
  int points = 0;       ///< at the ends of steps on which nothing was met
  double seconds = 0;   ///< median for one of them, with its index and multipliers
  int met = 0;          ///< folds, crossings and period doublings
  double locating = 0;  ///< median for one of them, with its share of the step
  std::optional<double> worst_action_slope, worst_momentum;  ///< see extremal::BranchRecord
  std::string end;                                           ///< why the family ended
};

/// From an orbit whose energy is given to the energy `to`.
extremal::ProblemFamily by_energy(const extremal::Problem& problem, double to);

/// Follows the family `repeat` times.
FamilyCost measure_family(const extremal::ProblemFamily& family, const extremal::SolveOptions& options,
                          int repeat);

}  // namespace bench
