#include "report/smooth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace extremal {
namespace {

TEST(Smooth, PassesThroughThePoints) {
  const Polyline points{{0, 1, 1.5, 1, 4}, {0, 2, -1, -3, 5}}, curve = smooth(points, 10);
  ASSERT_EQ(curve.x.size(), 41u);
  for (std::size_t k = 0; k < points.x.size(); ++k) {
    EXPECT_DOUBLE_EQ(curve.x[10 * k], points.x[k]);
    EXPECT_DOUBLE_EQ(curve.y[10 * k], points.y[k]);
  }
}

/// Halving the distance of the points divides the error by about eight.
TEST(Smooth, OfACircleIsOfThirdOrder) {
  const auto error = [](int count) {
    Polyline points;
    for (int k = 0; k <= count; ++k) {
      points.x.push_back(std::cos(1.7 + 1.2 * k / count));
      points.y.push_back(std::sin(1.7 + 1.2 * k / count));
    }
    const Polyline curve = smooth(points, 16);
    double worst = 0;
    for (std::size_t k = 0; k < curve.x.size(); ++k)
      worst = std::max(worst, std::abs(std::hypot(curve.x[k], curve.y[k]) - 1));
    return worst;
  };
  EXPECT_LT(error(8), 1e-3);
  EXPECT_GT(std::log2(error(8) / error(16)), 2.7);
}

/// As at a fold: the parameter turns at a point and is nowhere beyond it.
TEST(Smooth, TurnsAcrossAtPointsAlone) {
  const Polyline points{{0, 0.7, 1, 0.9, 0.2}, {0, 0.1, 0.3, 0.5, 1}};
  const Polyline curve = smooth(points, 50);
  EXPECT_EQ(*std::max_element(curve.x.begin(), curve.x.end()), 1);
  for (std::size_t k = 1; k < curve.x.size(); ++k) {
    EXPECT_GE((curve.x[k] - curve.x[k - 1]) * (k <= 100 ? 1 : -1), 0) << k;
    EXPECT_GE(curve.y[k], curve.y[k - 1]) << k;
  }
}

TEST(Smooth, BetweenTwoPointsIsTheLine) {
  const Polyline curve = smooth({{1, 3}, {2, -2}}, 4);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(curve.x[k], 1 + 0.5 * static_cast<double>(k), 1e-15);
    EXPECT_NEAR(curve.y[k], 2 - static_cast<double>(k), 1e-15);
  }
  EXPECT_EQ(smooth({{1}, {2}}, 4).x.size(), 1u);
}

}  // namespace
}  // namespace extremal
