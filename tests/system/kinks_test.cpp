#include "system/kinks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "formula_support.hpp"

namespace extremal {
namespace {

std::shared_ptr<const Lagrangian> written(std::vector<std::string> coordinates, std::string lagrangian) {
  return compile({.coordinates = std::move(coordinates), .lagrangian = std::move(lagrangian)}).lagrangian;
}

PointValues values(const Lagrangian& f, std::vector<double> q, std::vector<double> v, double t) {
  Scratch scratch;
  return evaluate_at(f, q, v, t, Order::gradient, scratch);
}

TEST(Kinks, SmoothLagrangiansHaveNone) {
  EXPECT_EQ(written({"x"}, "x'^2/2 - sqrt(1 + x^2)")->kinks(), nullptr);
  // Made of numbers alone, a kink is a number.
  EXPECT_EQ(written({"x"}, "abs(-2)*x'^2/2 - max(1, 3)*x")->kinks(), nullptr);
}

TEST(Kinks, EveryRowOfASumHasItsSurface) {
  const auto l = written({"q[4]"}, "sum(i, 1, 4, q[i]'^2/2 - sum(j, i + 1, 4, abs(q[i] - q[j])))");
  ASSERT_NE(l->kinks(), nullptr);
  EXPECT_EQ(l->kinks()->surfaces().size(), 6u);
}

/// Across u = 0 the gradient of L jumps by that of its odd part; each other surface has its own.
TEST(Kinks, GradientsJumpByTheOddPart) {
  const auto l = written({"x", "y"},
                         "(x'^2 + y'^2)/2 - (1 + y^2)*abs(x + y - t)^3/3 + (2 + x)*abs(x - y*t) "
                         "- 3*max(x^2, y + 0.5) + min(x*y, 2 - t)*x'");
  const auto surfaces = l->kinks()->surfaces();
  ASSERT_EQ(surfaces.size(), 4u);
  int tested = 0;
  for (const KinkSurface& surface : surfaces) {
    EXPECT_FALSE(surface.by_velocity);
    // Newton's method in y to the surface, from a point that is on none.
    const double t = 0.7;
    std::vector<double> q = {0.8, 0.6};
    const std::vector<double> v = {0.3, -0.4};
    for (int k = 0; k < 50; ++k) {
      const PointValues u = values(*surface.u, q, v, t);
      q[1] -= u.value / u.dq[1];
    }
    const PointValues u = values(*surface.u, q, v, t);
    ASSERT_LT(std::abs(u.value), 1e-12);
    const double beside = 1e-9;
    const double slope = std::hypot(u.dq[0], u.dq[1]);
    std::vector<double> above = q, below = q;
    for (int a = 0; a < 2; ++a) {
      above[a] += beside * u.dq[a] / slope;
      below[a] -= beside * u.dq[a] / slope;
    }
    const PointValues right = values(*l, above, v, t), left = values(*l, below, v, t);
    const std::vector<double> jump = values(*surface.odd, above, v, t).dq;
    for (int a = 0; a < 2; ++a) EXPECT_NEAR(right.dq[a] - left.dq[a], jump[a], 1e-7);
    const double later = values(*surface.u, q, v, t + 1e-6).value,
                 earlier = values(*surface.u, q, v, t - 1e-6).value;
    EXPECT_NEAR(values(*surface.u_by_time, q, v, t).value, (later - earlier) / 2e-6, 1e-8);
    tested += std::hypot(jump[0], jump[1]) > 0.1;
  }
  EXPECT_EQ(tested, 3);
}

TEST(Kinks, StepsAndVelocitiesAreKnown) {
  const auto l = written({"x"}, "x'^2/2 + x*step(t^2 - 2) + max(0, x')^2");
  const auto surfaces = l->kinks()->surfaces();
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_NE(surfaces[0].by_velocity, surfaces[1].by_velocity);
}

/// Second derivatives that are constant on both sides do not make the momentum one function of q'.
TEST(Kinks, MomentaThatJumpAreEvaluated) {
  for (const char* text :
       {"x'^2/2 + 0.3*abs(x')", "x'^2/2 - 0.3*max(2*x', -x')", "x'^2/2 + x*x' + abs(x' - 1)"}) {
    const auto l = written({"x"}, text);
    EXPECT_FALSE(l->structure().quadratic) << text;
    const double left = values(*l, {0}, {-2}, 0).dv[0], right = values(*l, {0}, {2}, 0).dv[0];
    EXPECT_GT(std::abs(right - left - 4), 0.1) << text;
  }
}

/// Powers of a base that vanishes on a kink: forces do not jump there, and all is finite on both sides.
TEST(Kinks, PowersAreFiniteBesideTheirKinks) {
  for (const char* text : {"-abs(x)^2.5", "-abs(x)^1.3", "-max(0, x)^2.5", "-max(0, -x)^1.5",
                           "-max(0, x)^1.7", "-max(0, 2*x - x^2)^1.25", "-sqrt(abs(x)^3)"}) {
    const auto l = written({"x"}, std::string("x'^2/2 ") + text);
    Scratch scratch;
    for (const double x : {-0.4, 0.4}) {
      const PointValues at = evaluate_at(*l, std::vector{x}, std::vector{0.1}, 0, Order::hessian, scratch);
      EXPECT_TRUE(std::isfinite(at.value + at.dq[0] + at.qq[0])) << text << " at " << x;
    }
    for (const KinkSurface& surface : l->kinks()->surfaces()) {
      const double jump = values(*surface.odd, {1e-14}, {0.1}, 0).dq[0];
      EXPECT_LT(std::abs(jump), 3e-3) << text;
    }
  }
}

}  // namespace
}  // namespace extremal
