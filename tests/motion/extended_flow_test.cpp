#include "motion/extended_flow.hpp"

#include <gtest/gtest.h>
#include <qd/dd_real.h>

#include <cmath>

#include "motion/dop853.hpp"
#include "motion/extrapolation.hpp"
#include "motion/flow.hpp"
#include "rivals/problems.hpp"

namespace extremal {
namespace {

/// A charge in a field along z and a spring, a constant momentum that does nothing, unequal masses coupled.
std::shared_ptr<const Lagrangian> charge() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[0] * v[1] / 2.0 + v[1] * v[1] + 0.7 * (q[0] * v[1] - q[1] * v[0]) + 0.3 * v[0] -
           q[0] * q[0] - q[1] * q[1] * q[1] * q[1];
  });
}

double rounded(const Extended& x) { return static_cast<double>(x); }
double rounded(const DoubleDouble& x) { return to_double(x); }

template <class Real>
class ExtendedFlows : public testing::Test {};
using Numbers = testing::Types<Extended, DoubleDouble>;
TYPED_TEST_SUITE(ExtendedFlows, Numbers);

TYPED_TEST(ExtendedFlows, AreTheFlow) {
  using Real = TypeParam;
  for (const auto& lagrangian : {kepler(), henon_heiles(), charge()}) {
    ASSERT_TRUE(ExtendedFlow<Real>::suits(*lagrangian));
    Flow flow(*lagrangian);
    ExtendedFlow<Real> extended(*lagrangian);
    const std::vector<double> q{0.6, -0.3}, v{0.2, 1.1};
    std::vector<double> y(q), slope(4);
    y.resize(4);
    ASSERT_TRUE(flow.momentum(q, v, 0, std::span(y).subspan(2)) && flow.slope(0, y, slope));
    const std::vector<Real> wide_q(q.begin(), q.end()), wide_v(v.begin(), v.end());
    std::vector<Real> wide(wide_q), wide_slope(4);
    wide.resize(4);
    ASSERT_TRUE(extended.momentum(wide_q, wide_v, Real(0.0), std::span(wide).subspan(2)));
    ASSERT_TRUE(extended.slope(Real(0.0), wide, wide_slope));
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(rounded(wide[k]), y[k], 1e-15) << k;
      EXPECT_NEAR(rounded(wide_slope[k]), slope[k], 1e-14) << k;
    }
    const double digits = std::is_same_v<Real, Extended> ? 1e-18 : 1e-30;
    for (int k = 0; k < 2; ++k) EXPECT_LT(std::abs(rounded(wide_slope[k] - wide_v[k])), digits) << k;
  }
}

TYPED_TEST(ExtendedFlows, RefuseInertiaThatVaries) {
  EXPECT_FALSE(ExtendedFlow<TypeParam>::suits(*double_pendulum()));
}

TYPED_TEST(ExtendedFlows, StopWhereForcesAreNotFinite) {
  const auto lagrangian = kepler();
  std::vector<TypeParam> slope(4);
  const std::vector<TypeParam> collision{0.0, 0.0, 1.0, 0.0};
  EXPECT_FALSE(ExtendedFlow<TypeParam>(*lagrangian).slope(TypeParam(0.0), collision, slope));
}

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
  EXPECT_LT((opening<Extended, ExtendedFlow<Extended>>(1e-18)), 1e-14);
  EXPECT_GT((opening<double, Flow>(1e-15)), 1e-13);
}

/// The same ellipse in steps that are too long for one extrapolation and have to be halved.
TEST(Extrapolation, ClosesAnEllipse) {
  const auto lagrangian = kepler();
  ExtendedFlow<DoubleDouble> flow(*lagrangian);
  Extrapolation method([&](DoubleDouble t, auto y, auto slope) { return flow.slope(t, y, slope); }, 4);
  const DoubleDouble e = 0.875;
  const std::vector<DoubleDouble> start{1.0 - e, 0.0, 0.0, sqrt((1.0 + e) / (1.0 - e))};
  std::vector<DoubleDouble> y = start;
  const DoubleDouble step = dd_real::_2pi / 4.0;
  for (int k = 0; k < 4; ++k) ASSERT_TRUE(method.advance(k * step, y, step, 1e-28));
  for (int k = 0; k < 4; ++k) EXPECT_LT(std::abs(to_double(y[k] - start[k])), 1e-23) << k;
}

}  // namespace
}  // namespace extremal
