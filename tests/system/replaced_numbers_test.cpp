#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "system/formula.hpp"
#include "system/kinks.hpp"

/// \file Numbers that are put into a compiled Lagrangian.

namespace extremal {
namespace {

using Values = std::map<std::string, std::vector<double>>;

SystemText with(SystemText text, const Values& values) {
  for (const auto& [name, value] : values) text.parameters[name] = {value, value.size() > 1};
  return text;
}

std::vector<double> in_order(const std::vector<std::string>& names, const Values& values) {
  std::vector<double> numbers;
  for (const std::string& name : names)
    numbers.insert(numbers.end(), values.at(name).begin(), values.at(name).end());
  return numbers;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-13 * (1 + std::abs(b[k]))) << k;
}

void expect_equal(const Lagrangian& a, const Lagrangian& b) {
  const int n = a.structure().coordinates;
  EXPECT_EQ(a.structure().quadratic, b.structure().quadratic);
  expect_near(a.structure().frequencies, b.structure().frequencies);
  Scratch scratch;
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int point = 0; point < 5; ++point) {
    std::vector<double> q(n), v(n);
    for (double& x : q) x = uniform(engine);
    for (double& x : v) x = uniform(engine);
    const double t = uniform(engine);
    const PointValues x = evaluate_at(a, q, v, t, Order::hessian, scratch),
                      y = evaluate_at(b, q, v, t, Order::hessian, scratch);
    expect_near({x.value}, {y.value});
    expect_near(x.dq, y.dq);
    expect_near(x.dv, y.dv);
    expect_near(x.qq, y.qq);
    expect_near(x.vq, y.vq);
    expect_near(x.vv, y.vv);
  }
}

/// Compiled at one set of values and given the other, and back.
void compare(SystemText text, const std::vector<std::string>& names, const Values& from, const Values& to) {
  text.active = names;
  text.replaceable = true;
  const auto form = compile(with(text, from)).lagrangian;
  text.active.clear();
  for (const Values& values : {to, from}) {
    const auto put = form->with(in_order(names, values));
    ASSERT_NE(put, nullptr);
    const auto anew = compile(with(text, values)).lagrangian;
    expect_equal(*put, *anew);
    ASSERT_EQ(put->kinks() == nullptr, anew->kinks() == nullptr);
    if (!put->kinks()) continue;
    const auto a = put->kinks()->surfaces(), b = anew->kinks()->surfaces();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      expect_equal(*a[k].u, *b[k].u);
      expect_equal(*a[k].u_by_time, *b[k].u_by_time);
      expect_equal(*a[k].odd, *b[k].odd);
    }
  }
}

TEST(ReplacedNumbers, OfMassesAndForces) {
  compare({.coordinates = {"x", "y"},
           .lagrangian = "m*(x'^2 + y'^2)/2 + c*x*y' + a*x' - k*x^4/4 - exp(-k*y)/(m + x^2)"},
          {"m", "c", "a", "k"}, {{"m", {1}}, {"c", {0.5}}, {"a", {2}}, {"k", {0}}},
          {{"m", {3}}, {"c", {-1}}, {"a", {0}}, {"k", {1.7}}});
}

TEST(ReplacedNumbers, OfMassesThatAreNotConstant) {
  compare({.coordinates = {"x"}, .definitions = {{"g", "m*(1 + x^2)"}}, .lagrangian = "g*x'^2/2 + m*x*x'^3"},
          {"m"}, {{"m", {1}}}, {{"m", {-2.5}}});
}

TEST(ReplacedNumbers, OfFrequencies) {
  compare({.coordinates = {"x"}, .lagrangian = "x'^2/2 + f*x*cos(w*t) - x^2*sin(2*w*t)"}, {"f", "w"},
          {{"f", {1}}, {"w", {2}}}, {{"f", {0.3}}, {"w", {0.7}}});
}

TEST(ReplacedNumbers, OfLists) {
  const SystemText bodies{.coordinates = {"x[4]"},
                          .lagrangian =
                              "sum(i, 1, 4, m[i]*x[i]'^2/2) + sum(i, 1, 3, sum(j, i + 1, 4, "
                              "m[i]*m[j]/(2 + (x[i] - x[j])^2)))"};
  compare(bodies, {"m"}, {{"m", {1, 1, 1, 1}}}, {{"m", {1, 2, 3, 4.5}}});
}

TEST(ReplacedNumbers, OfLongSums) {
  const SystemText chain{.coordinates = {"x[60]"},
                         .lagrangian =
                             "sum(i, 1, 60, x[i]'^2/2 - k*x[i]^2/2) - sum(i, 1, 59, c[i]*(x[i+1] - "
                             "x[i])^2/2 + k*(x[i+1] - x[i])^4/4)"};
  std::vector<double> equal(59, 1.0), other(59);
  for (std::size_t k = 0; k < other.size(); ++k) other[k] = 1 + 0.1 * std::sin(k);
  compare(chain, {"c", "k"}, {{"c", equal}, {"k", {1}}}, {{"c", other}, {"k", {0.2}}});
}

TEST(ReplacedNumbers, OfKinks) {
  compare({.coordinates = {"x", "y"},
           .lagrangian = "(x'^2 + y'^2)/2 - k*max(0, x - d)^2/2 - abs(y - d*cos(w*t))"},
          {"k", "d", "w"}, {{"k", {1}}, {"d", {0.1}}, {"w", {1}}}, {{"k", {3}}, {"d", {0.4}}, {"w", {2}}});
}

TEST(ReplacedNumbers, OfForces) {
  SystemText text{
      .coordinates = {"x"}, .parameters = {{"m", {{1}}}, {"c", {{0.1}}}}, .lagrangian = "m*x'^2/2 - x^2/2"};
  const std::vector<ForceText> forces{{.formula = "-c*m*x' + c^2*cos(t)", .where = "force.x"}};
  SystemText symbolic = text;
  symbolic.active = {"c", "m"};
  symbolic.replaceable = true;
  const auto put = compile_forces(symbolic, forces)->with(std::vector<double>{0.7, 2});
  ASSERT_NE(put, nullptr);
  expect_equal(*put, *compile_forces(with(text, {{"m", {2}}, {"c", {0.7}}}), forces));
}

TEST(ReplacedNumbers, OfHamiltonians) {
  SystemText text{.coordinates = {"x", "y"}, .hamiltonian = "(p_x - b*y)^2/(2*m) + p_y^2/(2*m) + b*x^2*p_y"};
  compare(text, {"m", "b"}, {{"m", {1}}, {"b", {0.3}}}, {{"m", {2.5}}, {"b", {-1}}});
}

TEST(ReplacedNumbers, NotOfExponents) {
  const SystemText text{.coordinates = {"x"},
                        .parameters = {{"a", {{2}}}},
                        .lagrangian = "x'^2/2 - x^a",
                        .active = {"a"},
                        .replaceable = true};
  EXPECT_EQ(compile(text).lagrangian->with(std::vector<double>{3}), nullptr);
}

TEST(ReplacedNumbers, NotWhereDerivativesAreAskedFor) {
  const SystemText text{
      .coordinates = {"x"}, .parameters = {{"a", {{2}}}}, .lagrangian = "x'^2/2 - a*x^2", .active = {"a"}};
  EXPECT_EQ(compile(text).lagrangian->with(std::vector<double>{3}), nullptr);
}

}  // namespace
}  // namespace extremal
