#include "solve/newton/sparse_border.hpp"

#include <gtest/gtest.h>

#include <cmath>

/// \file A sparse matrix with a border against the dense system.

namespace extremal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Neighbours of a ring coupled by springs of both signs, uniform shifts null; `stiff` is added everywhere.
MatrixXd ring(int n, double stiff) {
  MatrixXd h = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    const double k = i % 5 == 2 ? -0.7 : 1 + 0.3 * std::cos(i);
    h(i, i) += k + stiff;
    h(j, j) += k;
    h(i, j) -= k;
    h(j, i) -= k;
  }
  return h;
}

VectorXd vector(int n, double seed) {
  return VectorXd::NullaryExpr(n, [&](Eigen::Index i) { return std::sin(seed + 1.7 * i); });
}

/// H, with κ at pinned unknowns, factored sparsely.
void factor(const MatrixXd& h, double kappa, const std::vector<int>& pinned, SparseSymmetric& sparse) {
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int i = 0; i < h.rows(); ++i)
    for (int j = 0; j <= i; ++j)
      if (h(i, j) != 0) {
        rows.push_back(i);
        columns.push_back(j);
        values.push_back(h(i, j));
      }
  for (const int u : pinned) {
    rows.push_back(u);
    columns.push_back(u);
    values.push_back(kappa);
  }
  sparse.pattern(static_cast<int>(h.rows()), rows, columns);
  std::copy(values.begin(), values.end(), sparse.values());
  ASSERT_TRUE(sparse.factor());
}

/// With and without a first column, which may have a row of its own; H null along what is held, or nearly.
TEST(SparseBorder, SolvesTheWholeSystem) {
  const int n = 37;
  for (const double stiff : {0.0, 1e-12, 0.1})
    for (const int held : {0, 1, 2})
      for (const int first : {0, 1, 2}) {
        if (held == 0 && stiff < 1e-3) continue;
        const MatrixXd h = ring(n, stiff);
        MatrixXd directions(n, held);
        if (held > 0) directions.col(0).setOnes();
        if (held > 1) directions.col(1) = vector(n, 0.4);
        SparseBorder border;
        border.hold(directions);
        SparseSymmetric sparse;
        factor(h, 1.3, border.pinned(), sparse);
        const VectorXd t = vector(n, 2.1), own = vector(n, 3.3), b = vector(n, 0.9);
        const VectorXd row = first == 2 ? own : t;
        const std::span<const double> column(t.data(), first > 0 ? n : 0);
        border.factor(sparse, 1.3, column);
        VectorXd x = b;
        const double z =
            border.solve(sparse, {x.data(), std::size_t(n)}, {row.data(), std::size_t(n)}, 0.4, -0.8, true);
        const int m = (first > 0) + held;
        MatrixXd whole = MatrixXd::Zero(n + m, n + m);
        whole.topLeftCorner(n, n) = h;
        VectorXd right = VectorXd::Zero(n + m);
        right.head(n) = b;
        if (first > 0) {
          whole.col(n).head(n) = t;
          whole.row(n).head(n) = row;
          whole(n, n) = 0.4;
          right[n] = -0.8;
        }
        whole.block(0, n + m - held, n, held) = directions;
        whole.block(n + m - held, 0, held, n) = directions.transpose();
        const VectorXd truth = whole.fullPivLu().solve(right);
        EXPECT_LT((x - truth.head(n)).norm(), 1e-10 * truth.norm()) << stiff << held << first;
        if (first > 0) {
          EXPECT_NEAR(z, truth[n], 1e-10 * truth.norm()) << stiff << held << first;
        }
      }
}

/// Of the form across the directions, which count as null.
TEST(SparseBorder, InertiaAcrossWhatIsHeld) {
  const int n = 23;
  for (const double stiff : {0.0, 1e-12}) {
    const MatrixXd h = ring(n, stiff);
    SparseBorder border;
    border.hold(MatrixXd::Ones(n, 1));
    SparseSymmetric sparse;
    factor(h, 1, border.pinned(), sparse);
    border.factor(sparse, 1, {});
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(h).eigenvalues();
    const Inertia found = border.inertia(sparse, {}, 0);
    EXPECT_EQ(found.negative, (values.array() < -1e-6).count());
    EXPECT_EQ(found.positive, (values.array() > 1e-6).count());
    EXPECT_EQ(found.zero, 1);
    EXPECT_GT(found.negative, 2);
  }
}

}  // namespace
}  // namespace extremal
