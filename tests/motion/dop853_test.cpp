#include "motion/dop853.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "motion/dop853_tableau.hpp"

namespace extremal {
namespace {

using Stages = std::vector<long double>;

/// A rooted tree as its weight at each stage, Φ_i(t) = Π over subtrees Σ_j a_ij Φ_j, with its density γ.
struct Tree {
  Stages weight;
  long double density;
};

Stages graft(const Stages& subtree) {
  Stages result(dop853::stages, 0.0L);
  for (int i = 0; i < dop853::stages; ++i)
    for (int j = 0; j < i; ++j) result[i] += dop853::a<double>[i][j] * subtree[j];
  return result;
}

/// All rooted trees of each order up to `highest`: [order][number].
std::vector<std::vector<Tree>> rooted_trees(int highest) {
  std::vector<std::vector<Tree>> trees(highest + 1);
  for (int order = 1; order <= highest; ++order) {
    // Subtrees in non-increasing (order, number), so that each multiset comes once.
    const std::function<void(int, int, int, Tree)> add = [&](int left, int largest, int last, Tree tree) {
      if (left == 0) {
        tree.density *= order;
        trees[order].push_back(std::move(tree));
        return;
      }
      for (int size = std::min(left, largest); size >= 1; --size)
        for (int k = 0; k < static_cast<int>(trees[size].size()); ++k) {
          if (size == largest && k > last) break;
          Tree next = tree;
          const Stages branch = graft(trees[size][k].weight);
          for (int i = 0; i < dop853::stages; ++i) next.weight[i] *= branch[i];
          next.density *= trees[size][k].density;
          add(left - size, size, k, std::move(next));
        }
    };
    add(order - 1, order, 1 << 20, {Stages(dop853::stages, 1.0L), 1});
  }
  return trees;
}

/// Largest |Σ_i b_i Φ_i(t) − 1/γ(t)| over the trees of one order.
double defect_of_order(const std::vector<Tree>& trees, const dop853::Row<double>& weights) {
  long double largest = 0;
  for (const Tree& tree : trees) {
    long double sum = 0;
    for (int i = 0; i < dop853::stages; ++i) sum += weights[i] * tree.weight[i];
    largest = std::max(largest, std::abs(sum - 1 / tree.density));
  }
  return static_cast<double>(largest);
}

TEST(Dop853, OrderConditionsOfAllRootedTrees) {
  const auto trees = rooted_trees(9);
  const std::size_t counts[] = {0, 1, 1, 2, 4, 9, 20, 48, 115, 286};
  dop853::Row<double> b5 = dop853::b<double>;
  for (int i = 0; i < dop853::stages; ++i) b5[i] -= dop853::error5<double>[i];
  for (int order = 1; order <= 9; ++order) {
    ASSERT_EQ(trees[order].size(), counts[order]);
    if (order <= 8) {
      EXPECT_LE(defect_of_order(trees[order], dop853::b<double>), 2e-15) << order;
    }
    if (order <= 5) {
      EXPECT_LE(defect_of_order(trees[order], b5), 2e-15) << order;
    }
    if (order <= 3) {
      EXPECT_LE(defect_of_order(trees[order], dop853::b3<double>), 2e-15) << order;
    }
  }
  EXPECT_GT(defect_of_order(trees[9], dop853::b<double>), 1e-8);
  EXPECT_GT(defect_of_order(trees[6], b5), 1e-6);
  EXPECT_GT(defect_of_order(trees[4], dop853::b3<double>), 1e-4);
}

TEST(Dop853, StagesAreConsistent) {
  for (int i = 0; i < dop853::stages; ++i) {
    double sum = 0;
    for (int j = 0; j < i; ++j) sum += dop853::a<double>[i][j];
    EXPECT_NEAR(sum, dop853::c<double>[i], 2e-14) << i;
  }
}

/// y' = y², y(0) = 1: y = 1/(1 − t).
bool square(double, std::span<const double> y, std::span<double> slope) {
  slope[0] = y[0] * y[0];
  return true;
}

TEST(Dop853, OrderEightAsASlope) {
  const auto error = [](int steps) {
    Dop853 method(square, 1);
    double y = 1;
    for (int k = 0; k < steps; ++k) {
      EXPECT_TRUE(method.step(k * 0.75 / steps, {&y, 1}, 0.75 / steps));
      y = method.next()[0];
    }
    return std::abs(y - 4);
  };
  EXPECT_NEAR(std::log2(error(8) / error(16)), 8, 0.4);
  EXPECT_NEAR(std::log2(error(12) / error(24)), 8, 0.4);
}

TEST(Dop853, InterpolationOfOrderSeven) {
  // The error of one step of length h, against the solution through its start, falls as h⁸.
  const auto error = [](double h) {
    Dop853 method(square, 1);
    double t = 0, y = 1, between = 0, largest = 0;
    EXPECT_EQ(method.advance(t, {&y, 1}, 0.1, {.tolerance = 1}), Integrated::done);
    const double start = y;
    EXPECT_EQ(method.accept_step(t, {&y, 1}, t + h, {.tolerance = 1}), Integrated::done);
    EXPECT_EQ(t, 0.1 + h);
    EXPECT_TRUE(method.prepare_interpolation({&y, 1}, 1));
    for (const double theta : {0.0, 0.13, 0.4, 0.77, 1.0}) {
      method.interpolate(theta, {&between, 1});
      largest = std::max(largest, std::abs(between - start / (1 - start * theta * h)));
    }
    return largest;
  };
  EXPECT_NEAR(std::log2(error(0.08) / error(0.04)), 8, 0.5);
  EXPECT_LT(error(0.04), 1e-10);
}

TEST(Dop853, InExtendedPrecision) {
  DormandPrince<long double> method(
      [](long double, std::span<const long double> y, std::span<long double> slope) {
        slope[0] = y[0] * y[0];
        return true;
      },
      1);
  long double t = 0, y = 1, between = 0;
  EXPECT_EQ(method.advance(t, {&y, 1}, 0.75L, {.tolerance = 1e-18}), Integrated::done);
  EXPECT_NEAR(static_cast<double>(y - 4), 0, 2e-17);
  EXPECT_EQ(method.accept_step(t, {&y, 1}, 0.751L, {.tolerance = 1e-18}), Integrated::done);
  ASSERT_TRUE(method.prepare_interpolation({&y, 1}, 1));
  method.interpolate(0.5L, {&between, 1});
  EXPECT_NEAR(static_cast<double>(between - 1 / (1 - 0.7505L)), 0, 1e-16);
}

TEST(Dop853, ErrorFollowsTheTolerance) {
  for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
    Dop853 method(square, 1);
    double t = 0, y = 1;
    EXPECT_EQ(method.advance(t, {&y, 1}, 0.9, {.tolerance = tolerance}), Integrated::done);
    EXPECT_EQ(t, 0.9);
    EXPECT_NEAR(y, 10, 200 * tolerance);
  }
}

TEST(Dop853, BackwardsAndBySeveralEnds) {
  Dop853 method(square, 1);
  double t = 0, y = 1;
  for (const double end : {0.1, 0.1000001, 0.5, 0.9}) method.advance(t, {&y, 1}, end, {});
  EXPECT_NEAR(y, 10, 1e-10);
  method.advance(t, {&y, 1}, 0, {});
  EXPECT_EQ(t, 0);
  EXPECT_NEAR(y, 1, 1e-11);
}

TEST(Dop853, StopsAtASingularityAndSaysSo) {
  Dop853 method(square, 1);
  double t = 0, y = 1;
  EXPECT_NE(method.advance(t, {&y, 1}, 2, {.max_steps = 10000}), Integrated::done);
  EXPECT_NEAR(t, 1, 1e-3);
  EXPECT_TRUE(std::isfinite(y));
}

TEST(Dop853, RightHandSideThatCannotBeEvaluated) {
  Dop853 method(
      [](double t, auto, std::span<double> slope) {
        slope[0] = 1;
        return t <= 0.5;
      },
      1);
  double t = 0, y = 0;
  EXPECT_EQ(method.advance(t, {&y, 1}, 1, {}), Integrated::step_underflow);
  EXPECT_NEAR(t, 0.5, 1e-12);
  EXPECT_NEAR(y, 0.5, 1e-12);
}

}  // namespace
}  // namespace extremal
