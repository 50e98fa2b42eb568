#include <gtest/gtest.h>

#include <cmath>

#include "formula_support.hpp"

namespace extremal {
namespace {

TEST(FormulaSystem, NamesFollowTheDeclarations) {
  const System system = compile({.coordinates = {"x", "q[2]", "y"},
                                 .lagrangian = "(x'^2 + q[1]'^2 + q[2]'^2 + y'^2)/2 - x*y*q[1]*q[2]"});
  EXPECT_EQ(system.names, (std::vector<std::string>{"x", "q[1]", "q[2]", "y"}));
  ASSERT_EQ(system.coordinates.size(), 3u);
  EXPECT_EQ(system.coordinates[2].first, 3);
  EXPECT_EQ(system.lagrangian->structure().coordinates, 4);
}

TEST(FormulaSystem, ACompiledFormulaHasItsValueAndDerivatives) {
  const System system = compile({.coordinates = {"r", "phi"},
                                 .parameters = {{"mu", {{2}}}, {"m", {{3}}}},
                                 .definitions = {{"kinetic", "m*(r'^2 + r^2*phi'^2)/2"}, {"V", "-mu*m/r"}},
                                 .lagrangian = "kinetic - V"});
  Scratch scratch;
  const double r = 2, dr = 0.5, dphi = -1.5, m = 3, mu = 2;
  const PointValues at = evaluate_at(*system.lagrangian, std::vector<double>{r, 0.7},
                                     std::vector<double>{dr, dphi}, 0, Order::hessian, scratch);
  EXPECT_DOUBLE_EQ(at.value, m * (dr * dr + r * r * dphi * dphi) / 2 + mu * m / r);
  EXPECT_DOUBLE_EQ(at.dq[0], m * r * dphi * dphi - mu * m / (r * r));
  EXPECT_EQ(at.dq[1], 0);
  EXPECT_DOUBLE_EQ(at.dv[0], m * dr);
  EXPECT_DOUBLE_EQ(at.dv[1], m * r * r * dphi);
  EXPECT_DOUBLE_EQ(at.qq[0], m * dphi * dphi + 2 * mu * m / (r * r * r));
  EXPECT_DOUBLE_EQ(at.vv[0], m);
  EXPECT_DOUBLE_EQ(at.vv[3], m * r * r);
  EXPECT_DOUBLE_EQ(at.vq[2], 2 * m * r * dphi);
}

TEST(FormulaSystem, KernelsCompileToSparseHessians) {
  const int n = 200;
  const System system = compile({.coordinates = {"q[n]"},
                                 .parameters = {{"n", {{n}}}, {"alpha", {{0.25}}}},
                                 .lagrangian = "sum(i, 1, n, q[i]'^2)/2 - q[1]^2/2 - q[n]^2/2"
                                               " - sum(i, 1, n - 1, (q[i+1] - q[i])^2/2"
                                               " + alpha*(q[i+1] - q[i])^3/3)"});
  const Structure& structure = system.lagrangian->structure();
  EXPECT_TRUE(structure.quadratic);
  EXPECT_TRUE(structure.velocity_free);
  EXPECT_TRUE(structure.autonomous);
  EXPECT_EQ(structure.mass.size(), static_cast<std::size_t>(n));
  EXPECT_EQ(structure.hessian.size(), static_cast<std::size_t>(2 * n - 1));
  std::vector<double> q(n), v(n);
  for (int i = 0; i < n; ++i) q[i] = std::sin(0.1 * i * i);
  Scratch scratch;
  const PointValues at = evaluate_at(*system.lagrangian, q, v, 0, Order::gradient, scratch);
  for (int i = 0; i < n; ++i) {
    const double left = i > 0 ? q[i] - q[i - 1] : q[0], right = i + 1 < n ? q[i + 1] - q[i] : -q[n - 1];
    const double force =
        right - left + (i + 1 < n ? 0.25 * right * right : 0) - (i > 0 ? 0.25 * left * left : 0);
    EXPECT_NEAR(at.dq[i], force, 1e-14) << i;
  }
}

TEST(FormulaSystem, ErrorsComeOutOfCompile) {
  EXPECT_EQ(error_of([] { compile({.coordinates = {"x"}, .lagrangian = "x'^2/2 - y"}); }),
            "unknown name 'y'; is it a parameter that is not declared? | lagrangian | 9");
}

}  // namespace
}  // namespace extremal
