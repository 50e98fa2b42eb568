#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/element_hessian.hpp"
#include "solve/contact/limits.hpp"

/// \file The second variation of the coarse action among displacements that keep contacts.

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

}  // namespace

/// −Σ μ_k ∂²g_k/∂q², of g_k behind the projection onto the manifold where there are constraints.
MatrixXd CoarseAction::contact_curvature(std::span<const double> z, int node,
                                         std::span<const double> forces) const {
  const MatrixXd own = -curvature(*inequalities_.all, z, node, forces);
  if (!problem_.manifold) return own;
  const Manifold& manifold = *problem_.manifold;
  const MatrixXd slopes = at(manifold, z, node).slopes, across = manifold.metric() * slopes.transpose();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(n_);
  const ConstraintValues found = at(*inequalities_.all, z, node);
  for (std::size_t k = 0; k < forces.size(); ++k) force += forces[k] * found.slopes.row(k).transpose();
  const Eigen::VectorXd normal = solved(slopes * across, across.transpose() * force);
  return own + curvature(manifold, z, node, {normal.data(), static_cast<std::size_t>(normal.size())});
}

/// Displacements of an inner node that keep what is held or fixed there.
MatrixXd CoarseAction::displacements(std::span<const double> z, int node,
                                     const std::vector<int>& held) const {
  const Index constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  const Index fixed = std::ranges::count(waypoints_, node, &FixedCoordinate::node);
  const Index count = constraints + fixed + static_cast<Index>(held.size());
  if (count == 0) return MatrixXd::Identity(n_, n_);
  if (count >= n_) return MatrixXd(n_, 0);
  MatrixXd normals(n_, count);
  if (constraints > 0) normals.leftCols(constraints) = at(*problem_.manifold, z, node).slopes.transpose();
  const ConstraintValues found = at(*inequalities_.all, z, node);
  for (std::size_t i = 0; i < held.size(); ++i)
    normals.col(constraints + static_cast<Index>(i)) = found.slopes.row(held[i]);
  Index column = count - fixed;
  for (const FixedCoordinate& w : waypoints_)
    if (w.node == node) normals.col(column++) = Eigen::VectorXd::Unit(n_, w.coordinate);
  return complement(normals);
}

/// Displacements of both ends, 2n × f, along the relation.
MatrixXd CoarseAction::end_displacements(std::span<const double> z, const CoarseContacts& contacts) const {
  MatrixXd along = MatrixXd::Zero(2 * n_, problem_.ends.free);
  for (const Triplet& entry : problem_.ends.z) along(entry.row, entry.column) += entry.value;
  std::vector<Eigen::RowVectorXd> rows;
  for (Index i = 0; i < contacts.ends.slopes.rows(); ++i) rows.push_back(contacts.ends.slopes.row(i) * along);
  for (const int node : {0, elements_}) {
    const auto add = [&](const Eigen::RowVectorXd& slope) {
      const Eigen::RowVectorXd row = slope * along.middleRows(node == 0 ? 0 : n_, n_);
      if (row.norm() > limits::contact::rank * slope.norm()) rows.push_back(row.normalized());
    };
    const ConstraintValues found = at(*inequalities_.all, z, node);
    for (const int k : contacts.held[node]) add(found.slopes.row(k));
    if (!problem_.manifold) continue;
    const MatrixXd slopes = at(*problem_.manifold, z, node).slopes;
    for (Index j = 0; j < slopes.rows(); ++j) add(slopes.row(j));
  }
  if (rows.empty() || along.cols() == 0) return along;
  MatrixXd held(rows.size(), along.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) held.row(static_cast<Index>(i)) = rows[i];
  const SingularValues svd = singular_value_decomposition(held);
  const Index rank = (svd.values.array() > limits::contact::rank * svd.values[0]).count();
  return along * svd.v.rightCols(along.cols() - rank);
}

bool CoarseAction::positive(std::span<const double> z, const CoarseContacts& contacts) const {
  // Columns of inner nodes, in their order, then those of the ends.
  std::vector<MatrixXd> free(elements_ + 1);
  std::vector<Index> first(elements_ + 1);
  Index columns = 0;
  for (int k = 1; k < elements_; ++k) {
    free[k] = displacements(z, k, contacts.held[k]);
    first[k] = columns;
    columns += free[k].cols();
  }
  const MatrixXd ends = end_displacements(z, contacts);
  free[0] = ends.topRows(n_);
  free[elements_] = ends.bottomRows(n_);
  first[0] = first[elements_] = columns;
  columns += ends.cols();
  const Index times = columns;
  columns += static_cast<Index>(free_times_.size());
  if (columns == 0) return true;
  std::vector<Eigen::Triplet<double>> entries;
  const auto put = [&](Index row, Index column, const MatrixXd& block) {
    for (Index i = 0; i < block.rows(); ++i)
      for (Index j = 0; j < block.cols(); ++j)
        if (row + i >= column + j) entries.emplace_back(row + i, column + j, block(i, j));
  };
  const auto add = [&](int a, int b, const MatrixXd& block) {
    const MatrixXd reduced = free[a].transpose() * block * free[b];
    put(first[a], first[b], reduced);
    if (a != b) put(first[b], first[a], reduced.transpose());
  };
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = weighted(z, k, Order::hessian, 1, contacts.multipliers);
    const ElementHessian element = element_hessian(l, length(k), n_, limits::contact::shift);
    add(k, k, element.aa);
    add(k + 1, k + 1, element.bb);
    add(k + 1, k, element.ba);
  }
  for (int k = 0; k <= elements_; ++k)
    if (std::ranges::any_of(contacts.forces[k], [](double force) { return force != 0; }))
      add(k, k, (cell_end(k) - cell_begin(k)) * contact_curvature(z, k, contacts.forces[k]));
  if (contacts.ends.slopes.rows() > 0)
    put(first[0], first[0], ends.transpose() * contacts.ends.curvature * ends);
  const MatrixXd mixed = mixed_with_times(z, 1, contacts.multipliers);
  for (int k = 0; k <= elements_ && mixed.rows() > 0; ++k)
    put(times, first[k], mixed.middleCols(k * n_, n_) * free[k]);
  put(times, times, between_times(z, 1, contacts.multipliers));
  // Rows of integrals come last: each takes one direction, and makes one pivot negative.
  const MatrixXd integrals = integral_slopes(z);
  for (int k = 0; k <= elements_ && integrals.rows() > 0; ++k)
    put(columns, first[k], integrals.middleCols(k * n_, n_) * free[k]);
  put(columns, times, integral_rates(z));
  const Index all = columns + integrals.rows();
  Eigen::SparseMatrix<double> matrix(all, all);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors(
      matrix);
  return factors.info() == Eigen::Success && (factors.vectorD().array() < 0).count() == integrals.rows() &&
         (factors.vectorD().array() > 0).count() == columns;
}

}  // namespace extremal
