#include "linear/border.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "oracle.hpp"

namespace extremal {
namespace {

using dense::eps;
using dense::Matrix;
using dense::near_roundoff;

/// A chain with a border, and both as one dense matrix.
struct Bordered {
  Chain chain;
  Border border;
  Matrix full;

  void fill(const Matrix& c, const Matrix& r, const Matrix& d) {
    const int m = int(d.rows()), order = chain.order();
    const bool symmetric = c.transpose() == r;
    border.resize(order, m, symmetric);
    dense::Random::set(border.column_block(), c);
    if (!symmetric) dense::Random::set(border.row_block(), r.transpose());
    dense::Random::set(border.corner(), d);
    full.resize(order + m, order + m);
    full << dense::matrix(chain), c, r, d;
  }
  void expect_solves(int columns, double bound) {
    dense::Random random(columns);
    const Matrix b = random.matrix(int(full.rows()), columns);
    Matrix x = b;
    border.solve(chain, x.data(), columns);
    EXPECT_LE(dense::backward_error(full, x, b), bound)
        << chain.blocks() << " blocks of " << chain.size() << ", border " << border.columns();
  }
};

/// Free ends: translations are in the null space; `extra` is added to make it only nearly singular.
void fill_free(Chain& a, double extra) {
  const Matrix unit = Matrix::Identity(a.size(), a.size());
  for (int k = 0; k < a.blocks(); ++k) {
    const int neighbours = (k > 0) + (k + 1 < a.blocks());
    dense::Random::set(a.diagonal(k), (neighbours + extra) * unit);
    if (k + 1 < a.blocks()) dense::Random::set(a.lower(k), -unit);
  }
}

TEST(Border, SymmetricAgreesWithDense) {
  dense::Random random(1);
  Bordered s;
  for (int n : {1, 2, 3, 6, 7})
    for (int blocks : {0, 1, 2, 9, 30})
      for (int m : {0, 1, 2, 5}) {
        s.chain.resize(blocks, n);
        random.fill(s.chain, 1);
        const Matrix c = random.matrix(n * blocks, m);
        s.fill(c, c.transpose(), random.symmetric(m));
        ASSERT_TRUE(s.border.factor(s.chain));
        EXPECT_EQ(s.border.inertia(), dense::inertia(s.full)) << n << ' ' << blocks << ' ' << m;
        if (s.full.rows() > 0) s.expect_solves(1, near_roundoff);
        if (s.full.rows() > 0) s.expect_solves(4, near_roundoff);
      }
}

TEST(Border, UnsymmetricAgreesWithDense) {
  dense::Random random(2);
  Bordered s;
  for (int n : {1, 2, 3, 8})
    for (int blocks : {1, 2, 9, 30})
      for (int m : {1, 3}) {
        s.chain.resize(blocks, n);
        random.fill(s.chain, 1);
        s.fill(random.matrix(n * blocks, m), random.matrix(m, n * blocks), random.matrix(m, m));
        ASSERT_TRUE(s.border.factor(s.chain));
        s.expect_solves(3, near_roundoff);
        EXPECT_THROW(s.border.inertia(), std::logic_error);
      }
}

// Phase conditions: the chain is singular, the bordered system is not, whatever the size of what spoils it.
TEST(Border, SingularChain) {
  dense::Random random(3);
  Bordered s;
  for (double extra : {0.0, 1e-16, 1e-14, -1e-13, 1e-11, -1e-9, 1e-7, 1e-5})
    for (int n : {1, 2, 3, 7})
      for (int blocks : {1, 2, 10, 51})
        for (bool symmetric : {true, false}) {
          s.chain.resize(blocks, n);
          fill_free(s.chain, extra);
          const Matrix c = random.matrix(n * blocks, n);
          const Matrix r = symmetric ? Matrix(c.transpose()) : random.matrix(n, n * blocks);
          s.fill(c, r, Matrix::Zero(n, n));
          ASSERT_TRUE(s.border.factor(s.chain)) << extra << ' ' << n << ' ' << blocks;
          if (symmetric) {
            EXPECT_EQ(s.border.inertia(), dense::inertia(s.full)) << extra << ' ' << n << ' ' << blocks;
          }
          s.expect_solves(2, near_roundoff);
        }
}

// A null vector that is small where elimination ends: no pivot shows that the chain is singular.
TEST(Border, SingularChainThatNoPivotShows) {
  dense::Random random(4);
  Bordered s;
  for (int n : {1, 2, 4})
    for (int seed = 0; seed < 40; ++seed) {
      const int blocks = 7;
      s.chain.resize(blocks, n);
      Matrix g = Matrix::Identity(n * blocks, n * blocks), signs = g;
      for (int k = 0; k + 1 < blocks; ++k) g.block((k + 1) * n, k * n, n, n) = random.matrix(n, n) / 2;
      for (int k = 0; k < blocks; ++k) signs.block(k * n, k * n, n, n) *= k % 2 ? -1 : 1;
      signs(seed % blocks * n, seed % blocks * n) = 0;
      const Matrix a = g.transpose() * signs * g;
      for (int k = 0; k < blocks; ++k) {
        dense::Random::set(s.chain.diagonal(k), a.block(k * n, k * n, n, n));
        if (k + 1 < blocks) dense::Random::set(s.chain.lower(k), a.block((k + 1) * n, k * n, n, n));
      }
      const Matrix c = random.matrix(n * blocks, 1);
      s.fill(c, c.transpose(), Matrix::Zero(1, 1));
      ASSERT_TRUE(s.border.factor(s.chain));
      EXPECT_EQ(s.border.inertia(), dense::inertia(s.full));
      s.expect_solves(1, near_roundoff);
    }
}

TEST(Border, SingularSystemIsRefusedAndSolvedInLeastSquares) {
  dense::Random random(5);
  Bordered s;
  for (bool free : {false, true})
    for (bool symmetric : {true, false})
      for (int n : {1, 2, 3}) {
        s.chain.resize(12, n);
        if (free)
          fill_free(s.chain, 0);
        else
          random.fill(s.chain, 2);
        Matrix c = random.matrix(12 * n, 3), r = random.matrix(3, 12 * n), d = random.matrix(3, 3);
        if (free) c.setZero(), r.setZero();
        c.col(2) = c.col(0) + c.col(1);
        r.row(2) = 2 * r.row(0) - r.row(1);
        if (symmetric) r = c.transpose(), d = random.symmetric(3);
        d.col(2) = d.col(0) + d.col(1);
        d.row(2) = symmetric ? Matrix(d.row(0) + d.row(1)) : Matrix(2 * d.row(0) - d.row(1));
        s.fill(c, r, d);
        EXPECT_FALSE(s.border.factor(s.chain));
        EXPECT_LT(s.border.smallest_singular_value(), 1e-13);
        EXPECT_GT(s.border.condition(), 1e13);
        if (symmetric) {
          EXPECT_EQ(s.border.inertia(1e-12), dense::inertia(s.full));
        }
        EXPECT_THROW(s.border.solve(s.chain, s.full.data(), 1), std::logic_error);
        const Matrix b = random.matrix(int(s.full.rows()), 2);
        Matrix x = b;
        EXPECT_EQ(s.border.solve_least_norm(s.chain, x.data(), 2, 1e-10), free ? n + 1 : 1);
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> oracle;
        oracle.setThreshold(1e-10);
        oracle.compute(s.full);
        const Matrix expected = oracle.solve(b);
        EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm()) << n << ' ' << free << ' ' << symmetric;
      }
}

TEST(Border, LeastNormOfRegularSystemIsItsSolution) {
  dense::Random random(6);
  Bordered s;
  s.chain.resize(8, 2);
  random.fill(s.chain, 1);
  const Matrix c = random.matrix(16, 2), b = random.matrix(18, 1);
  s.fill(c, c.transpose(), random.symmetric(2));
  ASSERT_TRUE(s.border.factor(s.chain));
  Matrix x = b;
  EXPECT_EQ(s.border.solve_least_norm(s.chain, x.data(), 1, 1e-10), 0);
  EXPECT_LE(dense::backward_error(s.full, x, b), near_roundoff);
}

// S = −Cᵀ C for A = 1: its scaled entries are ±cosines of the columns.
TEST(Border, ConditionOfSchurComplement) {
  Chain a;
  a.resize(2, 1);
  a.diagonal(0)[0] = a.diagonal(1)[0] = 1;
  a.lower(0)[0] = 0;
  Border border;
  border.resize(2, 2);
  const double c[] = {1, 3, 0, 4};  // columns (1, 0) and (3, 4): cosine 3/5
  std::copy_n(c, 4, border.column_block());
  std::fill_n(border.corner(), 4, 0.0);
  ASSERT_TRUE(border.factor(a));
  EXPECT_NEAR(border.smallest_singular_value(), 1 - 0.6, 4 * eps);
  EXPECT_NEAR(border.condition(), 1.6 / 0.4, 16 * eps);
}

TEST(Border, MalformedIsRefused) {
  Border border;
  EXPECT_THROW(border.resize(-1, 2), std::invalid_argument);
  border.resize(4, 1);
  EXPECT_THROW(border.row_block(), std::logic_error);
  Chain a;
  a.resize(3, 1);
  try {
    border.factor(a);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "border: 4 rows around a chain of 3");
  }
}

TEST(Border, NotFiniteIsRefused) {
  dense::Random random(7);
  Bordered s;
  s.chain.resize(4, 2);
  random.fill(s.chain, 9);
  Matrix c = random.matrix(8, 1);
  c(3, 0) = std::nan("");
  s.fill(c, c.transpose(), Matrix::Zero(1, 1));
  EXPECT_FALSE(s.border.factor(s.chain));
  EXPECT_THROW(s.border.inertia(), std::logic_error);
  s.chain.diagonal(2)[0] = HUGE_VAL;
  EXPECT_FALSE(s.border.factor(s.chain));
}

}  // namespace
}  // namespace extremal
