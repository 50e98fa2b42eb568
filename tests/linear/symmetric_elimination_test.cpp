#include "linear/symmetric_elimination.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace extremal {
namespace {

using Eigen::MatrixXd;

/// Symmetric with eigenvalues of either sign, far from zero; deterministic.
MatrixXd indefinite(int n) {
  MatrixXd m(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) m(i, j) = std::sin(1 + 3.7 * i * j + i + j);
  m = (m + m.transpose()).eval();
  for (int i = 0; i < n; ++i) m(i, i) += (i % 3 == 0 ? -4 : 4) * std::sqrt(n);
  return m;
}

MatrixXd coupling(int rest, int n) {
  MatrixXd b(rest, n);
  for (int i = 0; i < rest; ++i)
    for (int j = 0; j < n; ++j) b(i, j) = std::cos(0.3 + 1.9 * i + 0.7 * j * i);
  return b;
}

void load(SymmetricElimination& to, const MatrixXd& a, const MatrixXd& b) {
  const int n = static_cast<int>(a.rows()), rest = static_cast<int>(b.rows());
  to.resize(n, rest);
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) to.pivot_row(i)[j] = a(i, j);
    for (int j = 0; j < rest; ++j) to.coupled_row(i)[j] = b(j, i);
  }
}

TEST(SymmetricElimination, GivesInertiaSchurComplementAndSolutions) {
  SymmetricElimination memory;
  for (const int n : {1, 2, 3, 5, 8, 17, 63, 64, 65, 130, 200})
    for (const int rest : {0, 1, 3, 8, 70}) {
      const MatrixXd a = indefinite(n), b = coupling(rest, n);
      load(memory, a, b);
      ASSERT_TRUE(memory.eliminate()) << n;
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues();
      EXPECT_EQ(memory.inertia().negative, (values.array() < 0).count()) << n;
      EXPECT_EQ(memory.inertia().positive, (values.array() > 0).count()) << n;
      const MatrixXd x = a.partialPivLu().solve(b.transpose()), schur = -b * x;
      double worst = 0;
      for (int i = 0; i < rest; ++i)
        for (int j = i; j < rest; ++j) worst = std::max(worst, std::abs(memory.rest_row(i)[j] - schur(i, j)));
      EXPECT_LE(worst, 1e-10 * (1 + n)) << n << ", " << rest;
      memory.substitute();
      worst = 0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < rest; ++j) worst = std::max(worst, std::abs(memory.coupled_row(i)[j] - x(i, j)));
      EXPECT_LE(worst, 1e-10) << n << ", " << rest;
    }
}

TEST(SymmetricElimination, RefusesPivotsThatLoseTheirDigits) {
  SymmetricElimination memory;
  MatrixXd a = indefinite(20);
  a.row(7) = a.row(3);
  a.col(7) = a.col(3);
  a(7, 7) = a(3, 3);
  load(memory, a, coupling(2, 20));
  EXPECT_FALSE(memory.eliminate());
}

}  // namespace
}  // namespace extremal
