#include "linear/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "oracle.hpp"

namespace extremal {
namespace {

using dense::eps;
using dense::Matrix;
using dense::near_roundoff;

const int sizes[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 20};
const int lengths[] = {1, 2, 3, 4, 5, 6, 7, 15, 31, 60};

/// Solves for random right-hand sides and compares with the dense matrix.
void expect_solves(const Chain& a, int columns, double bound) {
  dense::Random random(columns);
  const Matrix b = random.matrix(a.order(), columns);
  Matrix x = b;
  a.solve(x.data(), columns);
  EXPECT_LE(dense::backward_error(dense::matrix(a), x, b), bound)
      << a.blocks() << " blocks of " << a.size() << ", " << columns << " columns";
}

TEST(Chain, DefiniteNeedsNoPivoting) {
  dense::Random random(1);
  Chain a;
  for (int n : sizes)
    for (int blocks : lengths) {
      a.resize(blocks, n);
      random.fill(a, 6 * std::sqrt(n));
      ASSERT_TRUE(a.factor());
      EXPECT_FALSE(a.pivoted());
      EXPECT_EQ(a.inertia(), (Inertia{a.order(), 0, 0}));
      for (int columns : {1, 2, 3, 5, 8, 15}) expect_solves(a, columns, 4 * eps);
    }
}

TEST(Chain, IndefiniteAgreesWithDenseEigenvalues) {
  dense::Random random(2);
  Chain a;
  for (int n : sizes)
    for (int blocks : lengths) {
      if (n * blocks > 400) continue;
      a.resize(blocks, n);
      for (double shift : {0.0, 1.0, -2.0}) {
        random.fill(a, shift);
        ASSERT_TRUE(a.factor());
        EXPECT_EQ(a.inertia(), dense::inertia(dense::matrix(a))) << n << ' ' << blocks << ' ' << shift;
        for (int columns : {1, 2, 7}) expect_solves(a, columns, near_roundoff);
      }
    }
}

TEST(Chain, LongIndefiniteSolves) {
  dense::Random random(3);
  Chain a;
  for (int n : {12, 20}) {
    a.resize(60, n);
    random.fill(a, 0);
    ASSERT_TRUE(a.factor());
    expect_solves(a, 4, near_roundoff);
  }
}

// Each end and the middle, since the kernels start from both ends and meet in the middle.
TEST(Chain, SingularPivotBlockInNonsingularMatrix) {
  dense::Random random(4);
  Chain a;
  for (int n : sizes)
    for (int blocks : {2, 3, 4, 5, 8, 17}) {
      for (int zero : {0, blocks / 2, blocks - 1}) {
        a.resize(blocks, n);
        random.fill(a, 0.5);
        dense::Random::set(a.diagonal(zero), Matrix::Zero(n, n));
        ASSERT_TRUE(a.factor()) << n << ' ' << blocks << ' ' << zero;
        EXPECT_TRUE(a.pivoted() || zero > 0);
        EXPECT_EQ(a.inertia(), dense::inertia(dense::matrix(a))) << n << ' ' << blocks << ' ' << zero;
        expect_solves(a, 3, near_roundoff);
      }
    }
}

TEST(Chain, AllDiagonalBlocksZero) {
  dense::Random random(5);
  Chain a;
  for (int n : sizes)
    for (int blocks : {2, 4, 10}) {
      a.resize(blocks, n);
      random.fill(a, 0);
      for (int k = 0; k < blocks; ++k) dense::Random::set(a.diagonal(k), Matrix::Zero(n, n));
      ASSERT_TRUE(a.factor());
      EXPECT_EQ(a.inertia(), (Inertia{n * blocks / 2, n * blocks / 2, 0}));
      expect_solves(a, 2, near_roundoff);
    }
}

TEST(Chain, NearlySingularPivotBlock) {
  dense::Random random(6);
  Chain a;
  for (int n : {1, 2, 3, 4, 6, 7, 12})
    for (double tiny : {1e-6, 1e-10, 1e-13, 1e-16, 1e-40, 1e-160, 1e-300, 5e-324})
      for (int sign : {1, -1}) {
        a.resize(9, n);
        random.fill(a, 3);
        Eigen::VectorXd values = Eigen::VectorXd::Ones(n);
        values(n / 2) = sign * tiny;
        const Matrix q = Eigen::HouseholderQR<Matrix>(random.matrix(n, n)).householderQ();
        dense::Random::set(a.diagonal(0), q * values.asDiagonal() * q.transpose());
        dense::Random::set(a.diagonal(8), values.asDiagonal());
        ASSERT_TRUE(a.factor()) << n << ' ' << tiny;
        EXPECT_TRUE(a.pivoted());
        EXPECT_EQ(a.inertia(), dense::inertia(dense::matrix(a))) << n << ' ' << tiny;
        expect_solves(a, 1, near_roundoff);
        expect_solves(a, 5, near_roundoff);
      }
}

// A free chain: every translation is in the null space.
TEST(Chain, SingularIsCountedAndDeflated) {
  for (int n : {1, 2, 3, 5, 8})
    for (int blocks : {1, 2, 3, 10, 50}) {
      Chain a;
      a.resize(blocks, n);
      const Matrix unit = Matrix::Identity(n, n);
      for (int k = 0; k < blocks; ++k) {
        const int neighbours = (k > 0) + (k + 1 < blocks);
        dense::Random::set(a.diagonal(k), neighbours * unit / 3);
        if (k + 1 < blocks) dense::Random::set(a.lower(k), -unit / 3);
      }
      EXPECT_FALSE(a.factor());
      EXPECT_EQ(a.inertia(), (Inertia{n * (blocks - 1), 0, n})) << n << ' ' << blocks;
      ASSERT_EQ(int(a.deflated().size()), n);
      Matrix modified = dense::matrix(a);
      for (const Deflation& d : a.deflated()) modified(d.row, d.row) += d.amount;
      dense::Random random(7);
      const Matrix b = random.matrix(a.order(), 2);
      Matrix x = b;
      a.solve(x.data(), 2);
      EXPECT_LE(dense::backward_error(modified, x, b), near_roundoff);
    }
}

/// Also where pivot blocks, or the last one, are nearly singular.
TEST(Chain, SignsAgreeWithDenseEigenvalues) {
  dense::Random random(3);
  Chain a;
  for (int n : {1, 2, 5, 12})
    for (int blocks : {1, 2, 7, 15})
      for (double block : {0.0, 1e-13, 1.0}) {
        a.resize(blocks, n);
        random.fill(a, 0);
        for (int i = 0; i < n * n; ++i) a.diagonal(blocks / 2)[i] *= block;
        if (blocks == 1 && block == 0) continue;
        EXPECT_EQ(a.signs(), dense::inertia(dense::matrix(a))) << n << ' ' << blocks << ' ' << block;
      }
  a.diagonal(0)[0] = NAN;
  EXPECT_EQ(a.signs(), std::nullopt);
}

TEST(Chain, ZeroMatrixIsAllNull) {
  Chain a;
  a.resize(60, 20);
  for (int k = 0; k < 60; ++k) {
    dense::Random::set(a.diagonal(k), Matrix::Zero(20, 20));
    if (k < 59) dense::Random::set(a.lower(k), Matrix::Zero(20, 20));
  }
  EXPECT_FALSE(a.factor());
  EXPECT_EQ(a.inertia(), (Inertia{0, 0, 1200}));
}

// Singular in the middle of the chain by construction: A = Gᵀ S G with a singular S.
TEST(Chain, RankDeficientIndefinite) {
  dense::Random random(8);
  for (int n : {1, 2, 3, 4, 7})
    for (int null : {0, 3, 6}) {
      const int blocks = 7;
      Chain a;
      a.resize(blocks, n);
      Matrix g = Matrix::Identity(n * blocks, n * blocks), s = g;
      for (int k = 0; k + 1 < blocks; ++k) g.block((k + 1) * n, k * n, n, n) = random.matrix(n, n) / 2;
      for (int k = 0; k < blocks; ++k) s.block(k * n, k * n, n, n) *= k % 2 ? -1 : 1;
      s(null * n, null * n) = 0;
      const Matrix full = g.transpose() * s * g;
      for (int k = 0; k < blocks; ++k) {
        dense::Random::set(a.diagonal(k), full.block(k * n, k * n, n, n));
        if (k + 1 < blocks) dense::Random::set(a.lower(k), full.block((k + 1) * n, k * n, n, n));
      }
      EXPECT_FALSE(a.factor()) << n << ' ' << null;
      const Inertia expected = {n * 4 - (null % 2 == 0), n * 3 - (null % 2 == 1), 1};
      EXPECT_EQ(a.inertia(), expected) << n << ' ' << null;
    }
}

// By Sylvester's law scaling rows and columns does not change the inertia.
TEST(Chain, GradedScales) {
  dense::Random random(9);
  Chain a, b;
  for (int n : {1, 2, 3, 4, 6, 9})
    for (double step : {1e-1, 1e-3, 1e2, 1e8}) {
      const int blocks = 11;
      a.resize(blocks, n);
      b.resize(blocks, n);
      for (double shift : {0.0, 6 * std::sqrt(n)}) {
        random.fill(a, shift);
        for (int k = 0; k < blocks; ++k) {
          const double s = std::pow(step, k), t = s * step;
          for (int i = 0; i < n * n; ++i) b.diagonal(k)[i] = s * s * a.diagonal(k)[i];
          for (int i = 0; i < n * n && k + 1 < blocks; ++i) b.lower(k)[i] = s * t * a.lower(k)[i];
        }
        ASSERT_TRUE(b.factor()) << n << ' ' << step;
        EXPECT_EQ(b.inertia(), dense::inertia(dense::matrix(a)));
        expect_solves(b, 2, near_roundoff);
      }
    }
}

TEST(Chain, NotFiniteIsRefused) {
  dense::Random random(10);
  Chain a;
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (int n : {1, 2, 3, 4, 5, 6, 8, 13})
      for (int blocks : {1, 2, 5, 6}) {
        for (int k = 0; k < blocks; ++k)
          for (int entry : {0, n * n - 1}) {
            a.resize(blocks, n);
            random.fill(a, 9);
            a.diagonal(k)[entry] = bad;
            EXPECT_FALSE(a.factor()) << n << ' ' << blocks << ' ' << k << ' ' << entry << ' ' << bad;
            double x[100] = {};
            EXPECT_THROW(a.solve(x, 1), std::logic_error);
            if (k + 1 == blocks) continue;
            random.fill(a, 9);
            a.lower(k)[entry] = bad;
            EXPECT_FALSE(a.factor()) << n << ' ' << blocks << ' ' << k << ' ' << entry << ' ' << bad;
          }
      }
}

TEST(Chain, HugeAndTinyEntries) {
  dense::Random random(11);
  Chain a;
  for (double unit : {1e-290, 1e-150, 1e150, 1e290})
    for (int n : {1, 2, 5, 7}) {
      a.resize(6, n);
      random.fill(a, 5);
      for (int k = 0; k < 6; ++k) {
        for (int i = 0; i < n * n; ++i) a.diagonal(k)[i] *= unit;
        for (int i = 0; i < n * n && k < 5; ++i) a.lower(k)[i] *= unit;
      }
      ASSERT_TRUE(a.factor()) << unit;
      EXPECT_EQ(a.inertia(), dense::inertia(dense::matrix(a) / unit));
      Matrix b = random.matrix(a.order(), 1), x = b * unit;
      a.solve(x.data(), 1);
      EXPECT_LE(dense::backward_error(dense::matrix(a) / unit, x, b), near_roundoff);
    }
}

TEST(Chain, BlocksStayAndMemoryIsReused) {
  dense::Random random(12);
  Chain a;
  for (int blocks : {20, 3, 20, 1, 0}) {
    a.resize(blocks, 3);
    random.fill(a, 0);
    const Matrix before = dense::matrix(a);
    ASSERT_TRUE(a.factor());
    EXPECT_EQ(dense::matrix(a), before);
    const Chain copy = a;
    a.resize(blocks, 2);
    if (blocks > 0) expect_solves(copy, 2, near_roundoff);
  }
}

TEST(Chain, ShapesAreChecked) {
  Chain a;
  try {
    a.resize(-1, 0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "chain: -1 blocks of size 0; need at least 0 of at least 1");
  }
  a.resize(3, 2);
  double x[6] = {};
  EXPECT_THROW(a.solve(x, 1), std::logic_error);
}

}  // namespace
}  // namespace extremal
