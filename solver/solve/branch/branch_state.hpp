#pragma once

#include <optional>
#include <vector>

#include "solve/branch/branch.hpp"

/// \file A state on a branch: a path with its tangent, and all that the next step needs.

namespace extremal {

/// Of a periodic orbit, where its period may double.
struct DoublingTests {
  std::vector<double> values;     ///< of the multipliers; see doubling_tests()
  std::optional<int> index = {};  ///< see doubling_index()
};

/// What is zero at events, at a state so far back: see the fields of these names of BranchState.
struct EarlierTests {
  double back, crossing;
  DoublingTests doubling;
};

struct BranchState {
  Path path;
  Branch::Units units;  ///< lengths are measured in
  double coordinate = 0, varied = 0, action = 0;
  Move tangent;              ///< of length one
  Move bend, twist;          ///< of the branch off it, by σ² and σ³; empty if not known
  Move turning;              ///< of the tangent since the state before, by the way back to it; may be empty
  double back = 0;           ///< that way
  ClosingEquation closing;   ///< see Branch::closing
  std::vector<Move> family;  ///< see Branch::hold_family
  double rate = 0;           ///< ∂varied/∂s along the tangent
  double varied_error = 0;   ///< of the number that varies, by the error of the path
  double left = 0;           ///< what roundoff leaves of the way to the extremal of its own value
  double action_rate = 0;    ///< ∂S/∂s as its derivatives give it
  double energy_time = 0;    ///< |E T|
  int orientation = 1, index = 0, nullity = 0;
  bool index_resolved = false;  ///< pieces tell the index of its point, which `index` may differ from
  int open = 0;                 ///< directions that the equations leave open
  double crossing = 0;          ///< zero where branches cross; of the sign of the orientation
  DoublingTests doubling;
  std::vector<EarlierTests> earlier;  ///< of the states before, the nearest first, in the units of this one

  void scale(double factor);
  /// From the state, so far along the tangent.
  Move predicted(double length) const;
};

/// A step that succeeded.
struct BranchStep {
  const BranchState &from, &to;
  double length;  ///< along the tangent
};

}  // namespace extremal
