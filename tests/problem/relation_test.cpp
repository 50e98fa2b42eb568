#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "problem/problem.hpp"

namespace extremal {
namespace {

BoundaryRelation with_coordinates(int n) {
  BoundaryRelation relation;
  relation.coordinates = n;
  return relation;
}

BoundaryRelation relation_of(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& value) {
  BoundaryRelation relation = with_coordinates(static_cast<int>(matrix.cols() / 2));
  for (int i = 0; i < matrix.rows(); ++i) {
    const int row = relation.add_row(value[i]);
    for (int e = 0; e < matrix.cols(); ++e)
      if (matrix(i, e) != 0) relation.add(row, e, matrix(i, e));
  }
  return relation;
}

Eigen::MatrixXd matrix_of(const EndMap& map) {
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(map.offset.size(), map.free);
  for (const Triplet& entry : map.z) z(entry.row, entry.column) += entry.value;
  return z;
}

/// The row and the kind of the error, or {-1, false}.
std::pair<int, bool> error_of(const BoundaryRelation& relation) {
  try {
    solve_relation(relation);
  } catch (const RelationError& error) {
    return {error.row, error.contradiction};
  }
  return {-1, false};
}

TEST(Relation, FixedEnds) {
  BoundaryRelation relation = with_coordinates(2);
  relation.fix(0, false, 1);
  relation.fix(1, false, 2);
  relation.fix(0, true, 3);
  relation.fix(1, true, 4);
  const EndMap map = solve_relation(relation);
  EXPECT_EQ(map.free, 0);
  EXPECT_TRUE(map.z.empty());
  EXPECT_EQ(map.offset, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(map.fixed, (std::vector<char>{1, 1, 1, 1}));
}

TEST(Relation, NaturalEnds) {
  const EndMap map = solve_relation(with_coordinates(3));
  EXPECT_EQ(map.free, 6);
  EXPECT_EQ(matrix_of(map), Eigen::MatrixXd::Identity(6, 6));
  EXPECT_EQ(map.fixed, std::vector<char>(6, 0));
}

TEST(Relation, PeriodicUpToARotationLeavesTheStartFree) {
  const double angle = 2 * std::numbers::pi / 3, c = std::cos(angle), s = std::sin(angle);
  Eigen::MatrixXd matrix(2, 4);
  matrix << -c, s, 1, 0, -s, -c, 0, 1;
  const EndMap map = solve_relation(relation_of(matrix, Eigen::Vector2d(0.5, 0)));
  Eigen::MatrixXd expected(4, 2);
  expected << 1, 0, 0, 1, c, -s, s, c;
  EXPECT_EQ(matrix_of(map), expected);
  EXPECT_EQ(map.offset, (std::vector<double>{0, 0, 0.5, 0}));
}

TEST(Relation, RandomRelationsHoldForEveryFreeValueAndSpanTheNullSpace) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 1 + trial % 6, rows = static_cast<int>(uniform(random) * (2 * n + 1));
    const double density = uniform(random);
    Eigen::MatrixXd matrix(rows, 2 * n);
    for (double& x : matrix.reshaped()) x = uniform(random) < density ? normal(random) : 0;
    const Eigen::VectorXd value = Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); });
    const Eigen::VectorXd singular = rows == 0 ? Eigen::VectorXd() : matrix.jacobiSvd().singularValues();
    const bool full_rank = rows == 0 || singular[rows - 1] > 1e-3 * singular[0];
    if (!full_rank) {
      if (singular[rows - 1] < 1e-13) {
        EXPECT_GE(error_of(relation_of(matrix, value)).first, 0);
      }
      continue;
    }
    const EndMap map = solve_relation(relation_of(matrix, value));
    const Eigen::MatrixXd z = matrix_of(map);
    ASSERT_EQ(map.free, 2 * n - rows);
    const Eigen::VectorXd offset = Eigen::Map<const Eigen::VectorXd>(map.offset.data(), 2 * n);
    const double size = 1 + offset.norm() + z.norm();
    EXPECT_LE((matrix * offset - value).norm(), 1e-13 * size);
    EXPECT_LE((matrix * z).norm(), 1e-13 * size);
    if (map.free > 0) {
      EXPECT_EQ(z.fullPivLu().rank(), map.free);
    }
    for (int e = 0; e < 2 * n; ++e) EXPECT_EQ(map.fixed[e] != 0, z.row(e).isZero(0));
  }
}

TEST(Relation, RandomDependentRowIsNamed) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 2 + trial % 4, rows = n + 1;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::NullaryExpr(rows, 2 * n, [&] { return normal(random); });
    Eigen::VectorXd value = Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); });
    const int last = rows - 2 + trial % 2;
    const double scale = std::pow(10.0, trial % 13 - 6);
    matrix.row(last) = scale * (matrix.row(0) - 2 * matrix.row(last - 1));
    value[last] = scale * (value[0] - 2 * value[last - 1]);
    EXPECT_EQ(error_of(relation_of(matrix, value)), std::pair(last, false)) << trial;
    value[last] *= 1 + 1e-6;
    EXPECT_EQ(error_of(relation_of(matrix, value)), std::pair(last, true)) << trial;
  }
}

TEST(Relation, RepeatedAndContradictingSingleRows) {
  BoundaryRelation relation = with_coordinates(1);
  relation.fix(0, false, 0.3);
  relation.add(relation.add_row(0.6), 0, 2.0);
  EXPECT_EQ(error_of(relation), std::pair(1, false));
  relation.value[1] = 0.7;
  EXPECT_EQ(error_of(relation), std::pair(1, true));
}

TEST(Relation, TheLaterRowIsNamedAlsoWhereItIsTheSingleOne) {
  Eigen::MatrixXd matrix(3, 2);
  matrix << 1, 1, 1, -1, 1, 0;
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector3d(1, 0, 0.5))), std::pair(2, false));
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector3d(1, 0, 0.6))), std::pair(2, true));
}

TEST(Relation, RowsThatVanishOnceSingleRowsAreKnown) {
  Eigen::MatrixXd matrix(4, 4);
  matrix << 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 1, -1, 0;
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector4d(0.1, 0.2, 0.3, 0))), std::pair(3, false));
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector4d(0.1, 0.2, 0.3, 1))), std::pair(3, true));
}

TEST(Relation, EmptyRows) {
  BoundaryRelation relation = with_coordinates(1);
  const int row = relation.add_row(0);
  EXPECT_EQ(error_of(relation), std::pair(0, false));
  relation.add(row, 1, 0.25);
  relation.add(row, 1, -0.25);
  relation.value[row] = 1;
  EXPECT_EQ(error_of(relation), std::pair(0, true));
}

TEST(Relation, DependentRowsThatDifferInScale) {
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1e8, 1, 1, 1e-8;
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector2d(1e8, 1))), std::pair(1, false));
  matrix(1, 1) = 1e-4;
  EXPECT_EQ(error_of(relation_of(matrix, Eigen::Vector2d(1e8, 1))), std::pair(-1, false));
}

TEST(Relation, TinyCoefficientsAreKept) {
  Eigen::MatrixXd matrix(1, 2);
  matrix << 1, -1e-30;
  const Eigen::MatrixXd z = matrix_of(solve_relation(relation_of(matrix, Eigen::VectorXd::Zero(1))));
  EXPECT_EQ(z(0, 0), 1e-30);
}

TEST(Relation, AHundredThousandCoordinates) {
  constexpr int n = 100000;
  BoundaryRelation pinned = with_coordinates(n), closed = with_coordinates(n);
  for (int a = 0; a < n; ++a) {
    pinned.fix(a, false, a);
    pinned.fix(a, true, -a);
    const int row = closed.add_row(a % 2);
    closed.add(row, n + a, 1);
    closed.add(row, a, -1);
  }
  const EndMap fixed = solve_relation(pinned);
  EXPECT_EQ(fixed.free, 0);
  EXPECT_EQ(fixed.offset[n + 12345], -12345);
  const EndMap periodic = solve_relation(closed);
  EXPECT_EQ(periodic.free, n);
  EXPECT_EQ(periodic.z.size(), 2u * n);
  EXPECT_EQ(periodic.offset[n + 777], 1);
  const int sum = pinned.add_row(0);
  for (int a = 0; a < n; ++a) pinned.add(sum, a, 1);
  EXPECT_EQ(error_of(pinned), std::pair(2 * n, true));
}

TEST(Relation, MalformedIsRefusedWithTheNumbers) {
  BoundaryRelation relation = with_coordinates(2);
  relation.add(relation.add_row(0), 4, 1.0);
  try {
    solve_relation(relation);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "boundary entry (0, 4) outside 1 rows of 4 end coordinates");
  }
  relation.matrix[0] = {0, 1, std::nan("")};
  EXPECT_THROW(solve_relation(relation), std::invalid_argument);
  relation.matrix[0] = {0, 1, 1.0};
  relation.value[0] = HUGE_VAL;
  EXPECT_THROW(solve_relation(relation), std::invalid_argument);
}

}  // namespace
}  // namespace extremal
