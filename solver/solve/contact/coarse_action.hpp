#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <span>
#include <vector>

#include "problem/inequalities.hpp"
#include "problem/problem.hpp"
#include "solve/external/inequality_minimum.hpp"

/// \file The action of the midpoint rule on equal elements, under inequalities at the nodes.

namespace extremal {

/// A node and an inequality that is compared there.
struct NodeInequality {
  int node, constraint;
};

/// S_h = Σ h L((q_k + q_{k+1})/2, (q_{k+1} − q_k)/h, t_k + h/2) of N + 1 nodes z = (q_0 … q_N).
class CoarseAction {
 public:
  /// Keeps a reference to the problem.
  CoarseAction(const Problem& problem, int elements);

  int elements() const { return elements_; }
  double time(int node) const;
  /// Where inequalities are compared: at nodes that the boundary relation leaves free.
  const std::vector<NodeInequality>& places() const { return places_; }

  /// The minimum of S_h; its functions refer to this.
  InequalityMinimum minimum() const;

  /// The largest force along a path: of ∂L/∂q, and of momenta by the duration.
  double force(std::span<const double> z) const;

  /// Whether the second variation of S_h − Σ h μ g is positive, but for what symmetries make zero, among the
  /// displacements that keep the inequalities with `held` as equalities: a list for each node. μ: a list of
  /// all inequalities for each node.
  bool positive(std::span<const double> z, const std::vector<std::vector<int>>& held,
                const std::vector<std::vector<double>>& forces) const;

 private:
  using Block = Eigen::MatrixXd;
  struct Point {
    std::vector<double> q, v;
  };
  void midpoint(std::span<const double> z, int k, Point& point) const;
  PointValues values(std::span<const double> z, int k, Order order) const;
  /// Σ λ_k ∂²g_k/∂q².
  Block curvature(std::span<const double> z, int node, std::span<const double> multipliers) const;
  bool fixed(int node) const;
  bool hessian(std::span<const double> z, double factor, std::span<const double> multipliers,
               std::span<double> entries) const;

  const Problem& problem_;
  const Inequalities& inequalities_;
  int n_, elements_;
  double h_;
  std::vector<NodeInequality> places_;
};

}  // namespace extremal
