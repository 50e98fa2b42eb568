#include "motion/extended_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "rivals/problems.hpp"

namespace extremal {
namespace {

using Real = long double;

/// A charge in a field along z and a spring, a constant momentum that does nothing, unequal masses coupled.
std::shared_ptr<const Lagrangian> charge() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[0] * v[1] / 2.0 + v[1] * v[1] + 0.7 * (q[0] * v[1] - q[1] * v[0]) + 0.3 * v[0] -
           q[0] * q[0] - q[1] * q[1] * q[1] * q[1];
  });
}

TEST(ExtendedFlow, IsTheFlow) {
  for (const auto& lagrangian : {kepler(), henon_heiles(), charge()}) {
    ASSERT_TRUE(ExtendedFlow::suits(*lagrangian));
    Flow flow(*lagrangian);
    ExtendedFlow extended(*lagrangian);
    const std::vector<double> q{0.6, -0.3}, v{0.2, 1.1};
    std::vector<double> y(q), slope(4);
    y.resize(4);
    ASSERT_TRUE(flow.momentum(q, v, 0, std::span(y).subspan(2)) && flow.slope(0, y, slope));
    const std::vector<Real> wide_q(q.begin(), q.end()), wide_v(v.begin(), v.end());
    std::vector<Real> wide(wide_q), wide_slope(4);
    wide.resize(4);
    ASSERT_TRUE(extended.momentum(wide_q, wide_v, 0, std::span(wide).subspan(2)));
    ASSERT_TRUE(extended.slope(0, wide, wide_slope));
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(static_cast<double>(wide[k]), y[k], 1e-15) << k;
      EXPECT_NEAR(static_cast<double>(wide_slope[k]), slope[k], 1e-14) << k;
    }
  }
}

TEST(ExtendedFlow, RefusesInertiaThatVaries) { EXPECT_FALSE(ExtendedFlow::suits(*double_pendulum())); }

/// By how much Kepler's ellipse of eccentricity 7/8 is open after a revolution.
template <class Real, class AnyFlow>
double opening(double tolerance) {
  const auto lagrangian = kepler();
  AnyFlow flow(*lagrangian);
  DormandPrince<Real> method(
      [&](Real t, std::span<const Real> y, std::span<Real> slope) { return flow.slope(t, y, slope); }, 4);
  const Real e = 0.875L;
  const std::vector<Real> start{1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))};
  std::vector<Real> y = start;
  Real t = 0;
  EXPECT_EQ(method.advance(t, y, 2 * std::acos(Real(-1)), {.tolerance = tolerance, .block = 2}),
            Integrated::done);
  Real largest = 0;
  for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(y[k] - start[k]));
  return static_cast<double>(largest);
}

TEST(ExtendedFlow, ClosesAnEllipse) {
  EXPECT_LT((opening<long double, ExtendedFlow>(1e-18)), 1e-14);
  EXPECT_GT((opening<double, Flow>(1e-15)), 1e-13);
}

TEST(ExtendedFlow, StopsWhereForcesAreNotFinite) {
  const auto lagrangian = kepler();
  std::vector<Real> slope(4);
  const std::vector<Real> collision{0, 0, 1, 0};
  EXPECT_FALSE(ExtendedFlow(*lagrangian).slope(0, collision, slope));
}

}  // namespace
}  // namespace extremal
