#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/problem.hpp"
#include "solution/extension_values.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file Parts of a path along which the same inequalities are equalities: each is an extremal of its own.

namespace extremal {

/// How an arc is solved for between fixed ends, from its guess alone.
using ArcSolve = std::function<Solution(const Problem&, const SolveOptions&)>;

/// A part of a path.
struct PathArc {
  std::vector<int> held;    ///< ascending; empty: free
  double from = 0, to = 0;  ///< times
  Eigen::VectorXd start, end;
  Guess guess;                      ///< by t − from over to − from
  std::vector<double> multipliers;  ///< ν of integrals: the arc is an extremal of L + Σ ν g
};

/// An arc that has been solved for.
struct SolvedArc {
  bool found = false;
  std::string message;    ///< where it was not found
  Trajectory trajectory;  ///< from time 0
  Eigen::VectorXd p_start, p_end, v_start, v_end;
  double energy_end = 0;  ///< p·q' − L
  double action = 0, error = 0, residual = 0;
  int iterations = 0, degree = 0;
  bool minimizing = true;
  std::vector<WaypointImpulse> waypoints;  ///< at the times of the whole path
  std::vector<double> integrals;           ///< ∫ g dt
};

/// Solves arcs of one problem.
class Arcs {
 public:
  /// Keeps references.
  Arcs(const Problem& problem, const SolveOptions& options, const ArcSolve& solve);

  SolvedArc solve(const PathArc& arc);
  /// An arc that is the whole of a closed path; its duration is that of the problem, or the one found.
  SolvedArc solve_closed(const PathArc& arc);
  /// The manifold of the constraints and of inequalities as equations, in this order, with the forces of
  /// L + Σ ν g; null of none.
  std::shared_ptr<const Manifold> manifold(const std::vector<int>& held,
                                           const std::vector<double>& multipliers) {
    return system(held, multipliers).manifold;
  }
  std::shared_ptr<const Manifold> manifold(const PathArc& arc) { return manifold(arc.held, arc.multipliers); }
  /// Moves a point to where these inequalities are equalities. False if the iteration does not converge.
  bool project(const std::vector<int>& held, const std::vector<double>& multipliers, double t,
               Eigen::VectorXd& q);
  int iterations() const { return iterations_; }
  const Problem& problem() const { return problem_; }
  const SolveOptions& options() const { return options_; }
  /// L + Σ ν g as it is written.
  const Lagrangian& motion(const std::vector<double>& multipliers) {
    const HeldSystem& free = system({}, multipliers);
    return free.manifold ? free.manifold->lagrangian() : *free.lagrangian;
  }
  /// Constraints that hold along the whole path.
  int constraints() const { return problem_.manifold ? problem_.manifold->constraints() : 0; }

 private:
  struct Built {
    std::vector<double> multipliers;
    HeldSystem system;
  };
  const HeldSystem& system(const std::vector<int>& held, const std::vector<double>& multipliers);
  HeldSystem build(const std::vector<int>& held, const std::vector<double>& multipliers) const;
  bool determined(const std::vector<int>& held) const;
  std::vector<WaypointCondition> waypoints_in(const PathArc& arc) const;
  SolvedArc solve_extremal(const PathArc& arc, double tolerance);
  SolvedArc solve_problem(const PathArc& arc, Problem problem, double tolerance);
  SolvedArc solve_determined(const PathArc& arc);
  void measure(const PathArc& arc, SolvedArc& solved);
  void integrate(const PathArc& arc, SolvedArc& solved) const;

  const Problem& problem_;
  const SolveOptions& options_;
  const ArcSolve& solve_;
  std::map<std::vector<int>, Built> systems_;  ///< for the multipliers that were asked for last
  int iterations_ = 0;
};

/// The path of an arc as a guess for the same with other ends.
Guess guess_of(const Trajectory& trajectory);

}  // namespace extremal
