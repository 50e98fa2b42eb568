#pragma once

#include <array>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file What inequalities along the path forbid, as it is drawn.

namespace extremal {

/// A curve in the plane of a picture: of two coordinates, or of t and a lone one.
struct PlaneCurve {
  std::vector<double> x, y;
};

/// Where some inequality is an equality, in the plane about a path: its box with this part of the larger side
/// beside it. Nothing for three and more coordinates, and where what two coordinates must satisfy depends on
/// t.
std::vector<PlaneCurve> obstacle_boundaries(const Problem& problem, const Trajectory& trajectory,
                                            double beside);

}  // namespace extremal
