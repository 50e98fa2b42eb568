#pragma once

#include <string>
#include <vector>

#include "study/study.hpp"

/// \file Numbers that describe the points of a branch, as a bifurcation diagram shows them.

namespace extremal {

struct BranchQuantity {
  std::string name;            ///< of the axis
  std::vector<double> values;  ///< one for each point; NaN where a formula has none
};

/// Half the range of each coordinate along a trajectory.
std::vector<double> amplitudes(const Trajectory& trajectory);

/// Throws FormulaError where the formula cannot be read.
void check_quantity(const Study& study, const std::string& formula);

/// Values of a formula of end values x(0), x'(T), parameters, and the numbers `duration`, `energy`, `action`
/// and `amplitude`, unless parameters have these names. Without a formula the duration against the energy,
/// the energy against the duration, and the amplitude against a parameter. The amplitude is that of the
/// coordinate with the largest one on the branch.
BranchQuantity quantity(const Study& study, const FollowedBranch& branch, const std::string& formula = "");

}  // namespace extremal
