#include <gtest/gtest.h>

#include <cmath>

#include "system/copies.hpp"
#include "system/formula.hpp"

/// The Lagrangian of two copies of a system with forces.

namespace extremal {
namespace {

double value(const Lagrangian& l, std::vector<double> q, std::vector<double> v, double t = 0) {
  Scratch scratch;
  return evaluate_at(l, q, v, t, Order::value, scratch).value;
}

TEST(TwoCopies, AreTheDifferenceOfLagrangiansAndThePowerOfTheMeanForce) {
  const SystemText text{.coordinates = {"x", "y"},
                        .parameters = {{"k", {{3}}}},
                        .definitions = {{"r", "x^2 + y"}},
                        .lagrangian = "x'^2/2 + y'^2*x/2 - k*r + t*y"};
  const std::vector<ForceText> forces = {{.first = 0, .formula = "-x'*r + sin(t)", .where = "force.x"},
                                         {.first = 1, .formula = "r'/k", .where = "force.y"}};
  const auto both = compile_forces(text, forces);
  EXPECT_EQ(both->structure().coordinates, 4);
  const auto one = compile(text).lagrangian;
  const double t = 0.7;
  const std::vector<double> a{0.3, 0.8}, b{-0.2, 0.4}, va{1.1, 0.2}, vb{0.5, -0.6};
  const double x = 0.05, y = 0.6, vx = 0.8, vy = -0.2;  // means
  const double power =
      (-vx * (x * x + y) + std::sin(t)) * (a[0] - b[0]) + (2 * x * vx + vy) / 3 * (a[1] - b[1]);
  EXPECT_NEAR(value(*both, {a[0], a[1], b[0], b[1]}, {va[0], va[1], vb[0], vb[1]}, t),
              value(*one, a, va, t) - value(*one, b, vb, t) + power, 1e-14);
}

TEST(TwoCopies, OfTracedFunctors) {
  const LagrangianGraph l =
      trace_graph(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 - q[0] * q[0]; });
  const LagrangianGraph power =
      trace_graph(2, [](auto z, auto v, auto t) { return (t - v[0] * z[0]) * z[1]; });  // (q, λ)
  const auto both = make_lagrangian(two_copies(l, power));
  EXPECT_NEAR(value(*both, {0.5, 0.1}, {2, 1}, 3), (2 - 0.25) - (0.5 - 0.01) + (3 - 1.5 * 0.3) * 0.4, 1e-14);
  EXPECT_THROW(two_copies(l, l), std::invalid_argument);
}

/// A constant of both copies is one coordinate, behind them.
TEST(TwoCopies, ShareConstants) {
  const SystemText text{.coordinates = {"x", "k"}, .lagrangian = "x'^2/2 - k*x^2/2"};
  const auto both =
      compile_forces(text, std::vector<ForceText>{{.formula = "-k^2*x'", .where = "force.x"}}, 1);
  EXPECT_EQ(both->structure().coordinates, 3);
  const double k = 1.5, x = 0.6, y = -0.2, vx = 1.3, vy = 0.4;
  EXPECT_NEAR(value(*both, {x, y, k}, {vx, vy, 0}),
              (vx * vx - vy * vy) / 2 - k * (x * x - y * y) / 2 - k * k * (vx + vy) / 2 * (x - y), 1e-15);
}

/// Where the copies agree the derivatives by the first are those of L and the force, by the second their
/// opposites.
TEST(TwoCopies, GiveTheForceWhereTheyAgree) {
  const SystemText text{.coordinates = {"x"}, .lagrangian = "x'^2*(1 + x^2)/2 - x^4"};
  const auto both =
      compile_forces(text, std::vector<ForceText>{{.formula = "-3*x'*x^2", .where = "force.x"}});
  const auto one = compile(text).lagrangian;
  Scratch scratch;
  const std::vector<double> q{0.6}, v{1.3}, qq{0.6, 0.6}, vv{1.3, 1.3};
  const PointValues two = evaluate_at(*both, qq, vv, 0, Order::hessian, scratch),
                    l = evaluate_at(*one, q, v, 0, Order::hessian, scratch);
  const double force = -3 * 1.3 * 0.36;
  EXPECT_EQ(two.value, 0);
  EXPECT_NEAR(two.dq[0], l.dq[0] + force, 1e-14);
  EXPECT_NEAR(two.dq[1], -two.dq[0], 1e-15);
  EXPECT_NEAR(two.dv[0], l.dv[0], 1e-15);
  EXPECT_NEAR(two.vv[0], l.vv[0], 1e-15);
  EXPECT_NEAR(two.qq[0] + two.qq[1], l.qq[0] - 6 * 1.3 * 0.6, 1e-14);  // ∂F/∂q = −6 x' x
}

/// One formula in the index is one kernel with a row an element, whatever sums it holds; a list says the
/// same.
TEST(TwoCopies, OneFormulaServesAnArray) {
  const SystemText text{.coordinates = {"z", "q[40]"},
                        .lagrangian = "z'^2/2 + sum(i, 1, 40, q[i]'^2/2 - q[i]^2/2)"};
  const auto shared =
      compile_forces(text, std::vector<ForceText>{{.first = 1,
                                                   .count = 40,
                                                   .index = 1,
                                                   .formula = "-i*q[i]' + sum(j, 1, i, q[j])/10 + (-1)^i*z",
                                                   .where = "force.q"}});
  std::vector<ForceText> list;
  for (int i = 1; i <= 40; ++i) {
    std::string sum;
    for (int j = 1; j <= i; ++j) sum += (j > 1 ? " + q[" : "q[") + std::to_string(j) + "]";
    const std::string k = std::to_string(i);
    list.push_back({.first = i,
                    .count = 1,
                    .index = i,
                    .formula = "-" + k + "*q[" + k + "]' + (" + sum + ")/10 + (-1)^i*z",
                    .where = "force.q"});
  }
  const auto listed = compile_forces(text, list);
  std::vector<double> q, v;
  for (int a = 0; a < 82; ++a) {
    q.push_back(std::sin(1.0 + a));
    v.push_back(std::cos(2.0 * a));
  }
  Scratch scratch;
  const PointValues a = evaluate_at(*shared, q, v, 0.3, Order::hessian, scratch),
                    b = evaluate_at(*listed, q, v, 0.3, Order::hessian, scratch);
  EXPECT_NEAR(a.value, b.value, 1e-11);
  for (int c = 0; c < 82; ++c) EXPECT_NEAR(a.dq[c], b.dq[c], 1e-12) << c;
  for (int c = 0; c < 82 * 82; ++c) EXPECT_NEAR(a.vq[c], b.vq[c], 1e-12);
}

TEST(TwoCopies, AFormulaThatIsWrongIsNamed) {
  const auto refusal = [](ForceText force) -> std::string {
    try {
      force.where = "force.x";
      compile_forces({.coordinates = {"x"}, .lagrangian = "x'^2/2"}, std::vector<ForceText>{force});
    } catch (const FormulaError& e) {
      return e.where + ":" + std::to_string(e.offset) + ": " + e.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({.formula = "-c*x'"}).substr(0, 28), "force.x:1: unknown name 'c';");
  EXPECT_EQ(refusal({.formula = "multiplier[1]"}).substr(0, 37), "force.x:0: unknown name 'multiplier';");
  EXPECT_EQ(refusal({.formula = "i*x"}).substr(0, 28), "force.x:0: unknown name 'i';");
}

}  // namespace
}  // namespace extremal
