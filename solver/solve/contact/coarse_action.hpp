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

/// S_h = Σ h_k L((q_k + q_{k+1})/2, (q_{k+1} − q_k)/h_k, t_k + h_k/2) of N + 1 nodes z = (q_0 … q_N).
class CoarseAction {
 public:
  /// Keeps a reference to the problem.
  CoarseAction(const Problem& problem, int elements);
  /// The same on elements between these times, from 0 to T.
  CoarseAction(const Problem& problem, std::vector<double> times);

  int elements() const { return elements_; }
  double time(int node) const { return times_[node]; }
  double length(int element) const { return times_[element + 1] - times_[element]; }
  /// Half of the elements beside a node.
  double cell_begin(int node) const { return node == 0 ? 0 : (times_[node - 1] + times_[node]) / 2; }
  double cell_end(int node) const {
    return node == elements_ ? times_.back() : (times_[node] + times_[node + 1]) / 2;
  }
  /// Where inequalities are compared: at nodes that the boundary relation leaves free.
  const std::vector<NodeInequality>& places() const { return places_; }

  /// The minimum of S_h, in units of a path of this size; its functions refer to this.
  InequalityMinimum minimum(std::span<const double> z, double size) const;

  /// The largest force along a path: of ∂L/∂q, and of momenta by the duration.
  double force(std::span<const double> z) const;

  /// What a free duration makes zero: the energy, by its mean −∂S_h/∂T along the path, less the one given, or
  /// the condition that closes the duration.
  double closing(std::span<const double> z) const;

  /// ν of integrals at a minimum.
  std::vector<double> integral_multipliers(const MinimumReport& report) const;

  /// Whether the second variation of S_h + Σ ν ∫ g − Σ h μ g + Σ η r is positive, but for what symmetries
  /// make zero, among the displacements that keep integrals, constraints, conditions of the ends and the
  /// inequalities that are held.
  bool positive(std::span<const double> z, const CoarseContacts& contacts) const;

 private:
  using Block = Eigen::MatrixXd;
  struct Point {
    std::vector<double> q, v;
  };
  void midpoint(std::span<const double> z, int k, Point& point) const;
  /// Of L + Σ ν g; zeros: of L.
  PointValues values(std::span<const double> z, int k, Order order, std::span<const double> nu) const;
  PointValues values(std::span<const double> z, int k, Order order) const {
    return values(z, k, order, std::vector<double>(integrals()));
  }
  int integrals() const { return problem_.extension ? problem_.extension->multipliers() : 0; }
  ElementHessian element(std::span<const double> z, int k, std::span<const double> nu,
                         double kinetic_only) const;
  ElementHessian weighted(std::span<const double> z, int k, double factor, std::span<const double> nu) const;
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
  /// Of the relation of the ends and of waypoints.
  int linear_equations() const { return problem_.boundary.rows + static_cast<int>(waypoints_.size()); }
  void put_functions(InequalityMinimum& minimum) const;
  void put_units(std::span<const double> z, double size, InequalityMinimum& minimum) const;
  bool hessian(std::span<const double> z, double factor, std::span<const double> multipliers,
               std::span<double> entries) const;

  const Problem& problem_;
  const Inequalities& inequalities_;
  int n_, elements_;
  std::vector<double> times_;  ///< of nodes, from 0 to T
  std::vector<NodeInequality> places_;
  std::vector<FixedCoordinate> waypoints_;
  std::vector<int> constrained_;  ///< nodes at which the constraints are equations
};

}  // namespace extremal
