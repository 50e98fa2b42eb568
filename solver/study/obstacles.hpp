#pragma once

#include <array>
#include <optional>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file What inequalities along the path forbid, as it is drawn.

namespace extremal {

/// A curve in the plane of a picture: of two coordinates, or of t and a lone one.
struct PlaneCurve {
  std::vector<double> x, y;
  std::optional<double> t = {};  ///< it is there at this time alone
};

/// Where some inequality is an equality, in the plane about a path: its box with this part of the larger side
/// beside it. Where what two coordinates must satisfy depends on t, there are curves at several equal steps
/// of time. Nothing for three and more coordinates.
std::vector<PlaneCurve> obstacle_boundaries(const Problem& problem, const Trajectory& trajectory,
                                            double beside);

}  // namespace extremal
