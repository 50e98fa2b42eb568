#include "linear/cyclic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "oracle.hpp"

namespace extremal {
namespace {

using dense::eps;
using dense::Matrix;
using dense::near_roundoff;

void add(Matrix& full, int row, int column, const Matrix& b) {
  const auto n = b.rows();
  full.block(row * n, column * n, n, n) += b;
  full.block(column * n, row * n, n, n) += b.transpose();
}

Matrix fill(Cyclic& a, double shift, int border, dense::Random& random) {
  const int n = a.size(), blocks = a.blocks();
  Matrix full = Matrix::Zero(a.order(), a.order());
  for (int k = 0; k < blocks; ++k) {
    const Matrix d = random.symmetric(n) + shift * Matrix::Identity(n, n), b = random.matrix(n, n);
    dense::Random::set(a.diagonal(k), d);
    dense::Random::set(a.lower(k), b);
    full.block(k * n, k * n, n, n) += d;
    add(full, (k + 1) % blocks, k, b);
  }
  const Matrix c = random.matrix(n * blocks, border), corner = random.symmetric(border);
  dense::Random::set(a.column_block(), c);
  dense::Random::set(a.corner(), corner);
  full.topRightCorner(n * blocks, border) = c;
  full.bottomLeftCorner(border, n * blocks) = c.transpose();
  full.bottomRightCorner(border, border) = corner;
  return full;
}

TEST(Cyclic, AgreesWithDense) {
  dense::Random random(1);
  Cyclic a;
  for (int n : {1, 2, 3, 6, 9})
    for (int blocks : {1, 2, 3, 4, 20})
      for (int border : {0, 1, 3})
        for (double shift : {0.0, 3.0, 20.0}) {
          a.resize(blocks, n, border);
          const Matrix full = fill(a, shift, border, random);
          ASSERT_TRUE(a.factor());
          EXPECT_EQ(a.inertia(), dense::inertia(full)) << n << ' ' << blocks << ' ' << border << ' ' << shift;
          const Matrix b = random.matrix(a.order(), 3);
          Matrix x = b;
          a.solve(x.data(), 3);
          EXPECT_LE(dense::backward_error(full, x, b), near_roundoff) << n << ' ' << blocks << ' ' << border;
        }
}

// The ring −1, 2 − shift, −1 has eigenvalues 2 − 2 cos(2πj/N) − shift: two equal ones for j and N − j.
TEST(Cyclic, RingHasItsEigenvalues) {
  const int blocks = 24;
  Cyclic a;
  for (int count = 0; count < blocks / 2; ++count) {
    const double pi = std::numbers::pi;
    const double shift = 2 - std::cos(2 * pi * count / blocks) - std::cos(2 * pi * (count + 1) / blocks);
    a.resize(blocks, 1);
    for (int k = 0; k < blocks; ++k) a.diagonal(k)[0] = 2 - shift, a.lower(k)[0] = -1;
    ASSERT_TRUE(a.factor());
    EXPECT_EQ(a.inertia(), (Inertia{blocks - 2 * count - 1, 2 * count + 1, 0}));
  }
}

TEST(Cyclic, SymmetryIsNullAndPhaseConditionRemovesIt) {
  const int blocks = 10;
  Cyclic a;
  for (int border : {0, 1}) {
    a.resize(blocks, 1, border);
    for (int k = 0; k < blocks; ++k) {
      a.diagonal(k)[0] = 2, a.lower(k)[0] = -1;
      if (border) a.column_block()[k] = k == 3;
    }
    if (border) a.corner()[0] = 0;
    EXPECT_EQ(a.factor(), border == 1);
    EXPECT_EQ(a.inertia(), border ? (Inertia{blocks, 1, 0}) : (Inertia{blocks - 1, 0, 1}));
  }
  Matrix x = Matrix::Zero(blocks + 1, 1);
  x(0, 0) = 1, x(1, 0) = -1;  // no component along the symmetry: the multiplier vanishes
  a.solve(x.data(), 1);
  EXPECT_NEAR(x(blocks, 0), 0, 4 * eps);
  EXPECT_NEAR(x(3, 0), 0, 4 * eps);
  EXPECT_NEAR(2 * x(5, 0) - x(4, 0) - x(6, 0), 0, 8 * eps);
}

TEST(Cyclic, MalformedIsRefused) {
  Cyclic a;
  EXPECT_THROW(a.resize(0, 1), std::invalid_argument);
  try {
    a.resize(3, 2, -1);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "cyclic: 3 blocks of size 2 with a border of -1; need at least 1, 1, 0");
  }
}

}  // namespace
}  // namespace extremal
