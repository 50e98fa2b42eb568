#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <span>
#include <vector>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/problem.hpp"
#include "solve/contact/element_hessian.hpp"
#include "solve/contact/end_equations.hpp"
#include "solve/external/inequality_minimum.hpp"

/// \file The action of the midpoint rule on elements, equal ones at first, under inequalities at the nodes.

namespace extremal {

/// A node and an inequality that is compared there.
struct NodeInequality {
  int node, constraint;
};

/// A coordinate that a waypoint fixes at a node.
struct FixedCoordinate {
  int node, coordinate;
  double value;
};

/// What a path touches, for its second variation: for each node what is held, and μ of all inequalities.
struct CoarseContacts {
  std::vector<std::vector<int>> held;
  std::vector<std::vector<double>> forces;
  EndCurvature ends;
  std::vector<double> multipliers = {};  ///< ν of integrals
};

/// A stretch of time, in parts of the duration.
struct Stretch {
  double from, to;
  double length() const { return to - from; }
};

/// How many elements a coarse path has: equal ones between waypoints, and closer_elements in each of these
/// stretches, where they are shorter.
struct CoarseElements {
  int equal;
  std::vector<Stretch> closer = {};
};

std::vector<double> coarse_times(const Problem& problem, const CoarseElements& elements);

/// A waypoint whose time is free: the elements between the waypoints or ends beside it stretch with it.
/// Beside the last one of a path that may be shifted in time is the first, N nodes later.
struct FreeTime {
  int before, node, after;  ///< nodes
};

/// Of a waypoint whose time is free.
struct WaypointNode {
  int waypoint, node;  ///< numbers
};

/// S_h = Σ h_k L((q_k + q_{k+1})/2, (q_{k+1} − q_k)/h_k, t_k + h_k/2) of N + 1 nodes z = (q_0 … q_N).
/// Waypoints are at nodes.
class CoarseAction {
 public:
  /// Keeps a reference to the problem.
  CoarseAction(const Problem& problem, const CoarseElements& elements);
  /// The same on elements between these times, from 0 to T; each waypoint is at the nearest node.
  CoarseAction(const Problem& problem, std::vector<double> times);

  int coordinates() const { return n_; }
  int elements() const { return elements_; }
  double time(int node) const { return times_[node]; }
  const std::vector<double>& times() const { return times_; }
  double length(int element) const { return times_[element + 1] - times_[element]; }
  /// Half of the elements beside a node.
  double cell_begin(int node) const { return node == 0 ? 0 : (times_[node - 1] + times_[node]) / 2; }
  double cell_end(int node) const {
    return node == elements_ ? times_.back() : (times_[node] + times_[node + 1]) / 2;
  }
  /// How many lie between two times, with fractions.
  double elements_in(double from, double to) const;
  /// Where inequalities are compared: at nodes that the boundary relation leaves free.
  const std::vector<NodeInequality>& places() const { return places_; }
  const std::vector<WaypointNode>& free_waypoints() const { return free_waypoints_; }

  /// The minimum of S_h, for the values that unknown constants have in the problem, in units of a path of
  /// this size; its functions refer to this. Its variables are the nodes, then the free times in units in
  /// which the duration is as long as the path.
  InequalityMinimum minimum(std::span<const double> z, double size) const;
  /// Of nodes, with the free times of this action.
  std::vector<double> variables(std::span<const double> z, double size) const;
  /// Of all nodes, for such variables.
  std::vector<double> times_at(std::span<const double> variables, double size) const;
  std::vector<double> nodes_of(std::span<const double> variables) const {
    return {variables.begin(), variables.begin() + static_cast<std::ptrdiff_t>(nodes_size())};
  }

  /// The largest force along a path: of ∂L/∂q, and of momenta by the duration.
  double force(std::span<const double> z) const;

  /// What a free duration makes zero: the energy of L + Σ ν g, by its mean −∂S_h/∂T after the last waypoint,
  /// less the one given, or the condition that closes the duration.
  double closing(std::span<const double> z, std::span<const double> nu) const;

  int integrals() const { return problem_.extension ? problem_.extension->multipliers() : 0; }
  /// The values of k, and ν.
  std::vector<double> constants(std::span<const double> nu) const;
  /// What conditions miss that determine the unknown constants.
  std::vector<double> where(std::span<const double> z) const;
  /// ν of integrals at a minimum.
  std::vector<double> integral_multipliers(const MinimumReport& report) const;

  /// Whether the second variation of S_h + Σ ν ∫ g − Σ h μ g + Σ η r, by the path and the free times, is
  /// positive, but for what symmetries make zero, among the displacements that keep integrals, constraints,
  /// conditions of the ends and the inequalities that are held.
  bool positive(std::span<const double> z, const CoarseContacts& contacts) const;

 private:
  using Block = Eigen::MatrixXd;
  struct Point {
    std::vector<double> q, v;
  };
  void midpoint(std::span<const double> z, int k, Point& point) const;
  /// Of L + Σ ν g, also by the constants.
  PointValues values(std::span<const double> z, int k, Order order, std::span<const double> nu) const;
  PointValues values(std::span<const double> z, int k, Order order) const {
    return values(z, k, order, std::vector<double>(integrals()));
  }
  /// Of factor L + Σ ν g by q and q' alone.
  PointValues weighted(std::span<const double> z, int k, Order order, double factor,
                       std::span<const double> nu) const;
  int first_multiplier() const { return n_ + (problem_.extension ? problem_.extension->unknowns() : 0); }
  std::vector<double> integral_values(std::span<const double> z) const;
  Block integral_slopes(std::span<const double> z) const;
  /// Σ λ_k ∂²g_k/∂q² of inequalities or constraints.
  Block curvature(const Manifold& manifold, std::span<const double> z, int node,
                  std::span<const double> multipliers) const;
  Block contact_curvature(std::span<const double> z, int node, std::span<const double> forces) const;
  Block displacements(std::span<const double> z, int node, const std::vector<int>& held) const;
  Block end_displacements(std::span<const double> z, const CoarseContacts& contacts) const;
  ConstraintValues at(const Manifold& manifold, std::span<const double> z, int node) const;
  bool fixed(int node) const;
  void put_waypoints();
  /// The first waypoint, from which free times count if the path may be shifted in time; else 0.
  int origin() const { return shifts_ ? free_waypoints_.front().node : 0; }
  std::vector<int> nodes_beside(const FreeTime& free) const;
  /// ∂h_k/∂t of a free time.
  double stretch(const FreeTime& free, int element) const;
  bool ordered() const;
  CoarseAction at_variables(std::span<const double> variables, double size) const;
  Eigen::VectorXd velocity(std::span<const double> z, int k) const;
  Eigen::VectorXd time_slopes(std::span<const double> z) const;
  Block mixed_with_times(std::span<const double> z, double factor, std::span<const double> nu) const;
  Block between_times(std::span<const double> z, double factor, std::span<const double> nu) const;
  Block integral_rates(std::span<const double> z) const;
  /// Of the relation of the ends and of waypoints.
  int linear_equations() const { return problem_.boundary.rows + static_cast<int>(waypoints_.size()); }
  void put_places(InequalityMinimum& minimum) const;
  void put_action(InequalityMinimum& minimum, double size) const;
  void put_constraints(InequalityMinimum& minimum, double size) const;
  void put_units(std::span<const double> z, double size, InequalityMinimum& minimum) const;
  bool hessian(std::span<const double> z, double factor, std::span<const double> multipliers, double rate,
               std::span<double> entries) const;
  std::vector<double> ends(std::span<const double> z) const;  ///< q(0) and q(T)
  std::size_t nodes_size() const { return (elements_ + 1) * static_cast<std::size_t>(n_); }
  /// The variable of an end, e < 2n.
  int variable(int e) const { return e < n_ ? e : elements_ * n_ + e - n_; }

  const Problem& problem_;
  const Inequalities& inequalities_;
  int n_, elements_;
  std::vector<double> times_;  ///< of nodes, from 0 to T
  std::vector<NodeInequality> places_;
  std::vector<FixedCoordinate> waypoints_;
  std::vector<WaypointNode> free_waypoints_;
  std::vector<FreeTime> free_times_;
  bool shifts_ = false;           ///< it has waypoints, and may be shifted in time
  std::vector<int> constrained_;  ///< nodes at which the constraints are equations
};

}  // namespace extremal
