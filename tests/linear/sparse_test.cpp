#include "linear/sparse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "oracle.hpp"

namespace extremal {
namespace {

using dense::eps;
using dense::Matrix;
using dense::near_roundoff;

/// A symmetric matrix by entries of either triangle, with values that are refilled.
struct Entries {
  int n = 0;
  std::vector<int> rows, columns;
  std::vector<double> values;

  void add(int i, int j, double value) { rows.push_back(i), columns.push_back(j), values.push_back(value); }
  Matrix dense() const {
    Matrix full = Matrix::Zero(n, n);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      full(rows[k], columns[k]) += values[k];
      if (rows[k] != columns[k]) full(columns[k], rows[k]) += values[k];
    }
    return full;
  }
  bool factor(SparseSymmetric& a) const {
    std::copy(values.begin(), values.end(), a.values());
    return a.factor();
  }
};

/// A square lattice: fourth neighbours coupled at random, `shift` on the diagonal.
Entries lattice(int side, double shift, dense::Random& random) {
  Entries e;
  e.n = side * side;
  for (int i = 0; i < e.n; ++i) {
    e.add(i, i, random() + shift);
    if (i % side + 1 < side) e.add(i, i + 1, random());
    if (i + side < e.n) e.add(i + side, i, random());
  }
  return e;
}

void expect_solves(SparseSymmetric& a, const Matrix& full, double bound) {
  dense::Random random(1);
  const Matrix b = random.matrix(int(full.rows()), 3);
  Matrix x = b;
  a.solve(x.data(), 3);
  EXPECT_LE(dense::backward_error(full, x, b), bound);
}

TEST(Sparse, LatticeAgreesWithDense) {
  dense::Random random(2);
  SparseSymmetric a;
  for (int side : {1, 2, 5, 14}) {
    Entries e = lattice(side, 0, random);
    a.pattern(e.n, e.rows, e.columns);
    for (double shift : {0.0, 1.0, -3.0, 20.0}) {
      e.values = lattice(side, shift, random).values;  // same pattern, new numbers
      ASSERT_TRUE(e.factor(a));
      EXPECT_EQ(a.inertia(), dense::inertia(e.dense())) << side << ' ' << shift;
      expect_solves(a, e.dense(), near_roundoff);
      EXPECT_FALSE(a.pivoted() && shift == 20);
    }
  }
}

// Zero diagonal: pivots come in pairs.
TEST(Sparse, SaddleIsTakenInPairs) {
  dense::Random random(3);
  for (int n : {2, 10, 60}) {
    Entries e;
    e.n = n;
    for (int i = 0; i + 1 < n; ++i) e.add(i, i + 1, 1 + 0.1 * random());
    e.add(0, 0, 0);
    SparseSymmetric a;
    a.pattern(n, e.rows, e.columns);
    ASSERT_TRUE(e.factor(a));
    EXPECT_FALSE(a.pivoted());
    EXPECT_EQ(a.inertia(), (Inertia{n / 2, n / 2, 0}));
    expect_solves(a, e.dense(), near_roundoff);
  }
}

// Rows of a zero block meet nothing but distant others: in their fronts there is no pivot.
TEST(Sparse, FrontsWithoutPivotsAreLeftToLu) {
  dense::Random random(6);
  for (int half : {40, 90}) {
    Entries e;
    e.n = 2 * half;
    for (int i = 0; i < half; ++i) {
      e.add(half + i, half + i, random());
      for (int k : {0, 7, 19}) e.add(half + (i * 11 + k) % half, i, random());
      for (int k : {1, 5, 13, 17}) e.add(half + i, half + (i + k) % half, random());
    }
    SparseSymmetric a;
    a.pattern(e.n, e.rows, e.columns);
    ASSERT_TRUE(e.factor(a));
    EXPECT_TRUE(a.pivoted());
    EXPECT_EQ(a.inertia(), dense::inertia(e.dense()));
    expect_solves(a, e.dense(), near_roundoff);
  }
}

// Indefinite lattices moved to within `distance` of singular, on either side: the index steps by one.
TEST(Sparse, IndexNextToSingular) {
  dense::Random random(7);
  Entries e = lattice(12, 0, random);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Matrix>(e.dense(), Eigen::EigenvaluesOnly).eigenvalues();
  SparseSymmetric a;
  a.pattern(e.n, e.rows, e.columns);
  for (int negative : {20, 71, 72, 130})
    for (double distance : {1e-2, 1e-4, 1e-6, 1e-8}) {
      for (int side : {0, 1}) {
        Entries moved = e;
        for (std::size_t k = 0; k < e.values.size(); ++k)
          if (e.rows[k] == e.columns[k])
            moved.values[k] -= eigenvalues[negative] + (side == 0 ? -distance : distance);
        ASSERT_TRUE(moved.factor(a));
        const int expected = dense::inertia(moved.dense()).negative;
        EXPECT_EQ(a.inertia(), (Inertia{e.n - expected, expected, 0})) << negative << ' ' << distance;
        expect_solves(a, moved.dense(), near_roundoff);
      }
    }
}

TEST(Sparse, NearlySingularPivot) {
  dense::Random random(4);
  SparseSymmetric a;
  for (double tiny : {1e-8, 1e-13, 1e-16, 1e-100, 1e-300}) {
    Entries e;
    e.n = 3;
    e.add(0, 0, tiny);
    e.add(1, 0, 1);
    e.add(2, 1, 1);
    e.add(2, 2, -tiny);
    e.add(1, 1, 0.5);
    e.add(2, 0, 0.25);
    a.pattern(3, e.rows, e.columns);
    ASSERT_TRUE(e.factor(a)) << tiny;
    EXPECT_EQ(a.inertia(), dense::inertia(e.dense())) << tiny;
    expect_solves(a, e.dense(), near_roundoff);
  }
}

TEST(Sparse, SingularIsRefusedAndCounted) {
  Entries e;
  e.n = 30;  // a free chain: the translation is in the null space
  for (int i = 0; i + 1 < e.n; ++i) {
    e.add(i, i, 1);
    e.add(i + 1, i + 1, 1);
    e.add(i + 1, i, -1);
  }
  SparseSymmetric a;
  a.pattern(e.n, e.rows, e.columns);
  EXPECT_FALSE(e.factor(a));
  EXPECT_EQ(a.inertia(), (Inertia{29, 0, 1}));
  double x[30] = {};
  EXPECT_THROW(a.solve(x, 1), std::logic_error);
}

TEST(Sparse, GradedScales) {
  dense::Random random(5);
  Entries e = lattice(6, 1, random);
  const Inertia expected = dense::inertia(e.dense());
  for (std::size_t k = 0; k < e.values.size(); ++k)
    e.values[k] *= std::pow(10.0, (e.rows[k] + e.columns[k]) / 2.0 - 18);
  SparseSymmetric a;
  a.pattern(e.n, e.rows, e.columns);
  ASSERT_TRUE(e.factor(a));
  EXPECT_EQ(a.inertia(), expected);
  expect_solves(a, e.dense(), near_roundoff);
}

TEST(Sparse, RepeatedEntriesAddUp) {
  const std::vector<int> rows = {0, 1, 0, 1, 1}, columns = {0, 0, 1, 1, 1};
  SparseSymmetric a;
  a.pattern(2, rows, columns);
  const double values[] = {2, 0.25, 0.75, 1, 2};  // [2 1; 1 3]
  std::copy_n(values, 5, a.values());
  ASSERT_TRUE(a.factor());
  double x[] = {5, 10};
  a.solve(x, 1);
  EXPECT_NEAR(x[0], 1, 4 * eps);
  EXPECT_NEAR(x[1], 3, 8 * eps);
  SparseSymmetric moved = std::move(a);
  ASSERT_TRUE(moved.factor());
  EXPECT_EQ(moved.inertia(), (Inertia{2, 0, 0}));
}

TEST(Sparse, MalformedIsRefused) {
  SparseSymmetric a;
  const std::vector<int> rows = {0, 3}, columns = {0, 1};
  try {
    a.pattern(3, rows, columns);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "sparse: entry 1 at (3, 1) of order 3");
  }
  EXPECT_THROW(a.pattern(3, rows, std::span(columns).first(1)), std::invalid_argument);
  a.pattern(0, {}, {});
  EXPECT_TRUE(a.factor());
  a.pattern(4, rows, columns);
  std::fill_n(a.values(), 2, std::nan(""));
  EXPECT_FALSE(a.factor());
}

/// Each question of the deadline may be the last one: then nothing is factored, and the same matrix is later.
TEST(Sparse, EndsAtTheDeadline) {
  dense::Random random(7);
  const Entries e = lattice(12, 20, random);
  struct Questions {
    int left;
  };
  const auto after = [](Questions& questions) {
    return Deadline().or_stopped([](void* q) { return --static_cast<Questions*>(q)->left < 0; }, &questions);
  };
  SparseSymmetric a;
  Questions none{0};
  EXPECT_FALSE(a.pattern(e.n, e.rows, e.columns, after(none)));
  Questions many{1 << 20};
  ASSERT_TRUE(a.pattern(e.n, e.rows, e.columns, after(many)));
  std::copy(e.values.begin(), e.values.end(), a.values());
  ASSERT_TRUE(a.factor(after(many)));
  const int asked = (1 << 20) - many.left;
  EXPECT_GT(asked, 10);
  for (const int last : {0, 1, asked / 3}) {
    Questions few{last};
    EXPECT_FALSE(a.factor(after(few)));
    EXPECT_THROW(a.solve_step(std::vector<double>(e.n).data()), std::logic_error);
  }
  ASSERT_TRUE(e.factor(a));
  expect_solves(a, e.dense(), near_roundoff);
}

TEST(Sparse, NothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const std::vector<int> rows = {0, 1}, columns = {0, 0};
  SparseSymmetric a;
  a.pattern(3, rows, columns);
  std::fill_n(a.values(), 2, 0.0);
  EXPECT_FALSE(a.factor());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace extremal
