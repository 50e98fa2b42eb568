#pragma once

#include <limits>
#include <string>

#include "solve/mesh/resolution.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/iteration.hpp"

/// \file Newton's method run to a goal.

namespace extremal {

/// When a run of Newton steps may end, all relative to the largest range of a coordinate.
struct NewtonGoal {
  double remaining = least_correction;  ///< expected size of the next correction
  int steps = 50;
  bool reuse = false;                                               ///< begins with the factors there are
  double most_remaining = std::numeric_limits<double>::infinity();  ///< and, at worst
};

struct NewtonReport {
  bool reached = false;
  bool held = false;          ///< but for the direction in which the action is softest
  double remaining = 1;       ///< expected error that iterating further would remove, roundoff included
  double most_remaining = 1;  ///< at worst
  int steps = 0;
  std::string failure;  ///< why it was not reached
};

/// Steps until the goal, or until corrections are roundoff and shrink no more: full steps, and chord steps
/// where the last contraction was strong. `on_step` says after each whether there may be more; may be empty.
NewtonReport converge(NewtonIteration& newton, Path& path, const ElementTables& tables,
                      const NewtonGoal& goal, const std::function<bool()>& on_step);

/// The same from a guess. Where a full step goes too far, the direction in which the action is softest is
/// left out of all steps first: its curvature is not known, perhaps not its sign, as long as the path is
/// wrong in others (rank-deficient Newton; Deuflhard, Newton Methods for Nonlinear Problems, 4.4). If the
/// others converge, finer elements are to go on with all; `saved` is that path then, else memory.
NewtonReport approach(NewtonIteration& newton, Path& path, const ElementTables& tables,
                      const NewtonGoal& goal, Path& saved, const std::function<bool()>& on_step = {});

}  // namespace extremal
