#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/residual_test.hpp"

/// \file Mesh and degree chosen for a tolerance, while Newton converges.

namespace extremal {

/// From a path on coarse elements to an extremal that meets the tolerance. Newton on the coarse elements
/// until the path is known to a few digits, which shows the degree that the tolerance needs; then elements of
/// that degree, started a few digits off. Where no degree suffices, elements are halved.
class Refinement {
 public:
  enum class Result {
    converged,    ///< the path meets the tolerance
    failed,       ///< Newton found no extremal from this path; another may do
    unreachable,  ///< an extremal is near, but the tolerance is not met
  };

  Refinement(const Problem& problem, const SolveOptions& options, Workspace& workspace, Outcome& outcome);

  /// Steps that all paths from now on may take together, and that share of the time of one solve.
  void allow(int steps, double share = 1) {
    most_steps_ = outcome_.attempts + steps;
    cost_ = 0;
    share_ = share;
  }
  /// The same, unless more is left.
  void allow_at_least(int steps, double share) {
    most_steps_ = std::max(most_steps_, outcome_.attempts + steps);
    share_ = std::max(share_, cost_ / most_cost_ + share);
  }
  /// Keeps so many of them for what comes after.
  void keep(int steps) { most_steps_ -= steps; }
  int steps_left() const { return most_steps_ - outcome_.attempts; }
  bool exhausted() const {
    return outcome_.attempts >= most_steps_ || cost_ >= affordable() || options_.deadline.passed();
  }

  static constexpr int first_degree = 4;
  /// Makes the path of the outcome an empty one on `mesh`, to be filled by the caller.
  void open(const std::vector<double>& mesh, int degree = first_degree);
  /// The same for the path that there is, on elements of `tables`.
  void take(const ElementTables& tables);
  /// The path that was opened follows a motion through many encounters: its elements keep their ends, degrees
  /// rise before all are halved, and gradients are in extended precision.
  void keep_mesh() { mesh_kept_ = true; }
  bool mesh_kept() const { return mesh_kept_; }
  /// Whether the factors of a step from the path that was opened have lost digits.
  bool loses_digits();
  /// Of the factors of steps from the path that was opened.
  enum class Digits {
    of_double,
    doubled_where_lost,
    doubled,  ///< from the first step on
  };
  void set_digits(Digits digits) { digits_ = digits; }
  /// Steps from the path that was opened move its nodes in time: a soft shift of what lies between two rests
  /// bends values at fixed times by more than the forces that hold it.
  void move_nodes() {
    nodes_move_ = true;
    w_.iteration.move_nodes(true);
  }
  /// Binds the workspace's iteration to the problem again, after it was used for another.
  void rebind();
  /// Counts a step that the caller takes; false if there may be no more.
  bool count_step();
  /// Of the path that was opened last.
  const ElementTables& tables() const { return *tables_; }

  /// Refines the path.
  Result pursue();
  /// Refines the path again, on elements that end at these τ as well.
  Result pursue_with_ends_at(const std::vector<double>& ends);

  /// False if steps from this path were so long that the second variation is nearly singular, and other
  /// elements find another path.
  bool confirmed();
  /// Whether elements with other ends give the same path within the tolerance; their difference is an error.
  bool holds_on_other_elements();
  /// Whether a step from this path was much longer than the path.
  bool suspicious() const;

 private:
  enum class Attempt { converged, refine, failed, unreachable };
  static constexpr int highest_degree = 16;
  /// Extended precision takes longer: so many steps then count for one.
  static constexpr double extended_growth = 5;
  /// Elements are planned for this share of the tolerance: one more round costs more than a higher degree.
  static constexpr double spare = 0.1;
  /// Newton's method goes at least so far: its error is cheap to remove and hard to bound.
  static constexpr double loosest_newton = 1e-6;
  /// Before the elements changed: their truncation error; how far the mesh nodes moved since;
  /// whether Newton's method had gone to the end before.
  struct NodeError {
    Resolution::Error left_out;
    double moved = 0;
    bool from_converged = false;
  };
  Attempt attempt();
  Attempt refine_from(NewtonReport newton);
  Attempt judge(const NewtonReport& newton, double aim, const NodeError& nodes);
  void measure();
  void measure_momenta();
  double inertia() const;
  /// Newton until the remainder is below `error`, relative; `reuse`: with the factors there are.
  NewtonReport converge_to(double error, bool reuse);
  int steps_left(int wanted) const;
  double affordable() const { return share_ * most_cost_; }
  Plan plan(double aim);
  double excess(const Resolution::Error& error) const;
  std::optional<Resolution::Error> recovered(double q);
  void raise(int degree);
  void move_to(const ElementTables& tables, std::span<const double> mesh);
  bool end_at_kinks();
  void end_beside_closing();
  bool closes_beside_kinks() const;
  NewtonReport converge_with_kinks(NewtonReport newton);
  void adopt(const Plan& plan);
  void refine();
  void record();
  double phase_force() const;
  Attempt satisfy_natural_conditions(const NewtonReport& report);
  std::string hidden(double amplified) const;
  double step_cost() const;

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Outcome& outcome_;
  Path& path_;  ///< of the outcome
  Path saved_;  ///< that coarse elements left
  Scales scales_;
  int most_steps_ = 0, most_elements_ = 0;
  double cost_ = 0, first_cost_ = 0, most_cost_ = 0, share_ = 1;
  double first_magnitude_ = 0;  ///< of the path that is pursued
  bool varied_mass_ = false;    ///< with q
  double beside_ = 1;           ///< of T: elements of a closed path end at kinks farther from T than this
  bool mesh_kept_ = false;      ///< see keep_mesh()
  bool nodes_move_ = false;     ///< see move_nodes()
  Digits digits_ = Digits::of_double;
  double inertia_ = 0;         ///< of momenta by velocities where these are not all of momenta
  double momentum_range_ = 0;  ///< when last known
  ResidualTest test_;
  double longest_ = 0;      ///< undamped step so far, relative
  double left_out_ = 0;     ///< of q, by the elements that were judged last
  double held_ = INFINITY;  ///< relative to momenta, the force that held the phase when it was too large
  double worst_ = 0;        ///< error in units of the tolerance, when elements were last judged
  const ElementTables* tables_ = nullptr;
};

}  // namespace extremal
