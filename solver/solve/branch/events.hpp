#pragma once

#include <string>
#include <vector>

#include "solve/branch/branch_point.hpp"

/// \file All that is found on one step along a branch.

namespace extremal {

/// Why a branch ended.
enum class BranchEnd {
  none,             ///< it goes on
  not_started,      ///< no extremal to begin with
  target,           ///< it led where it was to lead
  points,           ///< as many points as were asked for
  closed,           ///< it came back to its first point
  rest,             ///< its orbits shrink onto an equilibrium
  infinite_period,  ///< its orbits approach one that takes for ever
  collision,        ///< the path needs ever more elements
  limit,            ///< there is no problem beyond, or L is not finite there
  too_short,        ///< steps became too short
  budget,           ///< the deadline has passed
};

/// Points on a step in their order, the regular one at its end left out, and whether the branch ends there.
struct StepEvents {
  std::vector<FoundPoint> points = {};
  BranchEnd end = BranchEnd::none;
  std::string message = {};
  int index_change = 0;  ///< see Crossings
  bool index_known = true;
  /// The value that the branch is to lead to was passed, and is not found; or the step leads to another
  /// branch.
  bool missed = false;
};

/// Leaves the tracker at another state.
StepEvents locate_events(Tracker& tracker, const EventSearch& search, const BranchStep& step);

}  // namespace extremal
