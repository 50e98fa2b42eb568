#include "solve/bordered/null_directions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace extremal {
namespace {

/// Of rank size − nullity: a band matrix between two sparse maps that leave out as many coordinates.
Eigen::SparseMatrix<double> singular_band(int size, int nullity) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd band = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = std::max(0, i - 2); j <= std::min(size - 1, i + 2); ++j) band(i, j) = normal(random);
  for (int k = 0; k < nullity; ++k) {
    const int at = (2 * k + 1) * size / (2 * nullity);
    band.col(at) = 0.5 * band.col(at - 1) - 0.25 * band.col(at + 1);
  }
  return band.sparseView();
}

class NullDirectionsOf : public testing::TestWithParam<int> {};

TEST_P(NullDirectionsOf, GiveTheSolutionOfLeastNorm) {
  const int size = 120, nullity = GetParam();
  const Eigen::SparseMatrix<double> a = singular_band(size, nullity);
  NullDirections directions;
  ASSERT_TRUE(directions.find(a, 1e-10));
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> dense(size, size);
  dense.setThreshold(1e-10).compute(Eigen::MatrixXd(a));
  ASSERT_EQ(dense.rank(), size - nullity);
  const Eigen::VectorXd reached = a * NullDirections::probe(size, 9), other = NullDirections::probe(size, 10);
  EXPECT_LT((directions.solve(reached) - dense.solve(reached)).norm(), 1e-10 * dense.solve(reached).norm());
  EXPECT_LT((directions.solve(other) - dense.solve(other)).norm(), 1e-8 * dense.solve(other).norm());
}

INSTANTIATE_TEST_SUITE_P(Nullities, NullDirectionsOf, testing::Values(1, 2, 4));

TEST(NullDirections, ARegularMatrixHasNone) {
  const int size = 80;
  Eigen::SparseMatrix<double> a(size, size);
  a.setIdentity();
  NullDirections directions;
  EXPECT_FALSE(directions.find(a, 1e-10));
}

}  // namespace
}  // namespace extremal
