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
  Guess guess;                    ///< by t − from over to − from
  std::vector<double> constants;  ///< unknowns k and multipliers ν: the arc is an extremal of L + Σ ν g
  /// In order. Times are those of the whole path; free ones are parts of the length of the arc.
  std::vector<WaypointCondition> waypoints = {};
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
                                           const std::vector<double>& constants) {
    return system(held, constants).manifold;
  }
  std::shared_ptr<const Manifold> manifold(const PathArc& arc) { return manifold(arc.held, arc.constants); }
  /// All inequalities as equations, for these constants.
  std::shared_ptr<const Manifold> inequalities(const std::vector<double>& constants);
  /// Moves a point to where these inequalities are equalities. False if the iteration does not converge.
  bool project(const std::vector<int>& held, const std::vector<double>& constants, double t,
               Eigen::VectorXd& q);
  int iterations() const { return iterations_; }
  const Problem& problem() const { return problem_; }
  const SolveOptions& options() const { return options_; }
  /// L + Σ ν g as it is written.
  const Lagrangian& motion(const std::vector<double>& constants) {
    const HeldSystem& free = system({}, constants);
    return free.manifold ? free.manifold->lagrangian() : *free.lagrangian;
  }
  /// Constraints that hold along the whole path.
  int constraints() const { return problem_.manifold ? problem_.manifold->constraints() : 0; }

 private:
  struct Built {
    std::vector<double> constants;
    HeldSystem system;
  };
  const HeldSystem& system(const std::vector<int>& held, const std::vector<double>& constants);
  HeldSystem build(const std::vector<int>& held, const std::vector<double>& constants) const;
  bool determined(const std::vector<int>& held) const;
  SolvedArc solve_extremal(const PathArc& arc, double tolerance);
  SolvedArc solve_problem(const PathArc& arc, Problem problem, double tolerance);
  SolvedArc solve_determined(const PathArc& arc);
  void measure(const PathArc& arc, SolvedArc& solved);
  void integrate(const PathArc& arc, SolvedArc& solved) const;

  const Problem& problem_;
  const SolveOptions& options_;
  const ArcSolve& solve_;
  std::map<std::vector<int>, Built> systems_;     ///< for the constants that were asked for last
  std::shared_ptr<const Manifold> inequalities_;  ///< for `constants_`
  std::vector<double> constants_;
  int iterations_ = 0;
};

/// An arc becomes the guess for the same with other ends.
void put_guess(const SolvedArc& solved, PathArc& arc);

}  // namespace extremal
