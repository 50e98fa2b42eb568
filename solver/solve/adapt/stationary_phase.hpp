#pragma once

#include <functional>
#include <vector>

#include "solve/newton/converge.hpp"

/// \file The phases of a closed path at which a scheme on equal steps has an extremal.

namespace extremal {

/// S_h of equal elements does not change when a closed path is shifted by one of them. Between, it does, by
/// less than any power of the step: too little for Newton's method, of which a step shifts the path by the
/// force along the shift divided by how that force changes. So the shift is an equation of its own (Lyapunov
/// and Schmidt): s(σ) is S_h of the path that all other equations give, shifted by σ elements. As s has the
/// period 1, s' has zeros on both sides, and the zero nearest to the path is less than one element away.
class StationaryPhase {
 public:
  /// Newton's method with the shift held, from a path nearby; false if it does not converge.
  using Solve = std::function<bool(Path&)>;
  StationaryPhase(const Problem& problem, NewtonIteration& newton, const ElementTables& tables, Solve solve);

  /// Moves a path that is an extremal but for a force along the shift. False if there is none nearby without
  /// this force, or with one that is less than `enough` of the largest momentum: the path is then where it
  /// was.
  bool find(Path& path, double enough);

 private:
  struct Point {
    double shift, force;  ///< σ, s'(σ)
    double residual;      ///< of all equations, relative to the largest momentum
    Path path;
  };
  Point measured(double shift, Path path);
  void measure_direction(const Path& path);
  bool shift(const Point& from, double to, Point& result);
  bool bracket(const Path& path, Point& a, Point& b);
  Point zero_between(Point a, Point b);

  const Problem& problem_;
  NewtonIteration& newton_;
  const ElementTables& tables_;
  Solve solve_;
  std::vector<double> direction_;  ///< of the nodes, (N + 1) × n: by one element
};

}  // namespace extremal
