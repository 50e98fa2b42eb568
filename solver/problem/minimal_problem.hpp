#pragma once

#include <memory>
#include <span>
#include <vector>

#include "problem/problem.hpp"

/// \file A problem with constraints in minimal coordinates: system/minimal_expressions.hpp.

namespace extremal {

class MinimalLagrangian;
struct MinimalSystem;

/// The same extremals near the guess, as long as they stay in the chart.
struct MinimalProblem {
  Problem problem;  ///< of u
  std::shared_ptr<const MinimalLagrangian> lagrangian;
  double stretch = 1;  ///< |∂q/∂u| along the guess
  /// What it was made of.
  std::shared_ptr<const Lagrangian> whole;
  BoundaryRelation boundary;
  Duration duration;
  Guess guess;
  /// The same in another chart, for extremals that leave this one; null: there is none.
  std::shared_ptr<const MinimalProblem> next = nullptr;
};

/// Points of q, one after the other.
struct LiftedPoints {
  std::vector<double> q, v;     ///< n each
  std::vector<double> stretch;  ///< |∂q/∂u|: the largest sum of a row
};
LiftedPoints lifted(const MinimalProblem& minimal, std::span<const double> u, std::span<const double> du,
                    std::span<const double> t);

/// A covector at q whose part along the manifold is p, a covector of u.
std::vector<double> covector(const MinimalProblem& minimal, std::span<const double> q,
                             std::span<const double> p);

/// Whether it is still that of a problem, which may have been changed since.
bool describes(const MinimalProblem& minimal, const Problem& problem);

/// Nothing where the ends of a problem are not ends of u, where it asks for what charts do not have, or where
/// |∂q/∂u| along the guess exceeds `most_stretch`.
std::shared_ptr<const MinimalProblem> minimal_problem(const Problem& problem, MinimalSystem system,
                                                      double most_stretch);

/// The same with another system, other ends and another duration, as where a parameter varies, near the
/// guess of the other. `problem` needs no guess.
std::shared_ptr<const MinimalProblem> minimal_problem_like(const MinimalProblem& other, Problem problem,
                                                           MinimalSystem system);

}  // namespace extremal
