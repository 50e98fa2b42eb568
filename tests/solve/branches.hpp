#pragma once

#include "solve/branch/diagram.hpp"
#include "solve/laws.hpp"

/// \file Branches of extremals: followed to their end, and what is on them.

namespace extremal::laws {

/// Over a parameter of the problem.
inline ProblemFamily varied(const std::function<Problem(double)>& at, double from, double to) {
  return {at(from), Varied::parameter, from, to, [at](double p) { return std::optional<Problem>(at(p)); }};
}

inline State start_of(const BranchPoint& point) { return at(point.solution.trajectory, 0); }

inline std::vector<BranchPoint> follow(Continuation& branch) {
  std::vector<BranchPoint> points;
  while (branch.advance()) points.push_back(branch.point());
  return points;
}

/// Where points of a kind are.
inline std::vector<double> values(const std::vector<BranchPoint>& points, PointKind kind) {
  std::vector<double> found;
  for (const BranchPoint& point : points)
    if (point.kind == kind) found.push_back(point.parameter);
  return found;
}

}  // namespace extremal::laws
