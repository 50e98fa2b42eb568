#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formula_support.hpp"

namespace extremal {
namespace {

std::string name(int k) { return fmt::format("d{}", k); }

std::vector<double> sample(int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> values(count);
  for (double& value : values) value = uniform(engine);
  return values;
}

using Table = std::vector<std::uint32_t>;

TEST(FormulaGraph, APlainLagrangianIsOneTerm) {
  const LagrangianGraph l = graph_of({.coordinates = {"x", "y", "z"},
                                      .parameters = {{"mu", {{2}}}},
                                      .definitions = {{"r", "sqrt(x^2 + y^2)"}},
                                      .lagrangian = "(x'^2 + y'^2)/2 + mu/r + 0*z"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.coordinates, 3);
  EXPECT_EQ(l.terms[0].rows(), 1);
  EXPECT_EQ(l.terms[0].arity, 4);
  EXPECT_EQ(l.terms[0].table, (Table{0, 1, 3, 4}));
  EXPECT_TRUE(l.uniforms.empty());
  EXPECT_EQ(value_of(l, {3, 4, 9}, {1, 2, 9}, 0), 2.9);
}

TEST(FormulaGraph, TimeAndVelocitiesAreInputs) {
  const SystemText text{.coordinates = {"x", "q[2]"}, .lagrangian = "q[2]'*x - t*q[1] + cos(t)*x'"};
  EXPECT_DOUBLE_EQ(value_of(text, {2, 3, 4}, {5, 6, 7}, 0.5), 7 * 2 - 0.5 * 3 + std::cos(0.5) * 5);
  EXPECT_EQ(graph_of(text).terms[0].table, (Table{0, 1, 3, 5, 6}));
}

TEST(FormulaGraph, ActiveParametersStaySymbolic) {
  const LagrangianGraph l = graph_of({.coordinates = {"x"},
                                      .parameters = {{"g", {{9.81}}}, {"k", {{2}}}, {"l", {{0.5}}}},
                                      .lagrangian = "k*x'^2/2 - g*l*x",
                                      .active = {"l", "g"}});
  EXPECT_EQ(l.parameters, 2);
  EXPECT_EQ(l.uniforms, (std::vector<double>{0.5, 9.81}));
  EXPECT_EQ(l.terms[0].table, (Table{0, 1, 3, 4}));
  EXPECT_DOUBLE_EQ(value_of(l, {2}, {3}, 0), 9 - 9.81);
}

TEST(FormulaGraph, AChainIsOneKernelWithATable) {
  const LagrangianGraph l = graph_of({.coordinates = {"q[n]"},
                                      .parameters = {{"n", {{5}}}, {"alpha", {{0.25}}}},
                                      .lagrangian = "sum(i, 1, n, q[i]'^2/2) - q[1]^2/2 - q[n]^2/2"
                                                    " - sum(i, 1, n - 1, (q[i+1] - q[i])^2/2"
                                                    " + alpha*(q[1 + i] - q[i])^3/3)"});
  ASSERT_EQ(l.terms.size(), 3u);
  EXPECT_EQ(l.terms[0].table, (Table{0, 4}));
  EXPECT_EQ(l.terms[1].arity, 1);
  EXPECT_EQ(l.terms[1].table, (Table{5, 6, 7, 8, 9}));
  EXPECT_EQ(l.terms[2].arity, 2);
  EXPECT_EQ(l.terms[2].table, (Table{0, 1, 1, 2, 2, 3, 3, 4}));
  EXPECT_TRUE(l.uniforms.empty());
  const std::vector<double> q = sample(5, 1), v = sample(5, 2);
  double exact = -q[0] * q[0] / 2 - q[4] * q[4] / 2;
  for (int i = 0; i < 5; ++i) exact += v[i] * v[i] / 2;
  for (int i = 0; i < 4; ++i)
    exact -= std::pow(q[i + 1] - q[i], 2) / 2 + 0.25 * std::pow(q[i + 1] - q[i], 3) / 3;
  EXPECT_NEAR(value_of(l, q, v, 0), exact, 1e-15);
}

TEST(FormulaGraph, PairSumsFlattenAndTakeOuterFactorsIn) {
  const std::vector<double> m{1, 2, 4, 8};
  const SystemText text{.coordinates = {"x[4]", "y[4]"},
                        .parameters = {{"G", {{0.5}}}, {"m", {m, true}}},
                        .definitions = {{"pairs",
                                         "sum(i, 1, 4, m[i]*sum(j, i + 1, 4, m[j]/"
                                         "sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2)))"},
                                        {"kinetic", "sum(i, 1, 4, m[i]*(x[i]'^2 + y[i]'^2))/2"}},
                        .lagrangian = "kinetic + G*pairs"};
  const LagrangianGraph l = graph_of(text);
  ASSERT_EQ(l.terms.size(), 2u);
  EXPECT_EQ(l.terms[0].rows(), 4);
  EXPECT_EQ(l.terms[0].arity, 3);
  EXPECT_EQ(l.terms[1].rows(), 6);
  EXPECT_EQ(l.terms[1].arity, 5);
  // Uniforms: m/2, then G m m; equal ones (G·1·2 = m/2 = 1) are shared.
  EXPECT_EQ(l.uniforms, (std::vector<double>{0.5, 1, 2, 4, 8, 16}));
  const Table& table = l.terms[1].table;
  EXPECT_EQ(Table(table.begin() + 15, table.begin() + 20), (Table{1, 2, 5, 6, 20}));  // row (2, 3)
  const std::vector<double> q = sample(8, 3), v = sample(8, 4);
  double exact = 0;
  for (int i = 0; i < 4; ++i) {
    exact += m[i] * (v[i] * v[i] + v[4 + i] * v[4 + i]) / 2;
    for (int j = i + 1; j < 4; ++j) exact += 0.5 * m[i] * m[j] / std::hypot(q[i] - q[j], q[4 + i] - q[4 + j]);
  }
  EXPECT_NEAR(value_of(l, q, v, 0), exact, 1e-14);
}

TEST(FormulaGraph, IndicesMayStandAsNumbers) {
  const LagrangianGraph l =
      graph_of({.coordinates = {"q[3]"}, .lagrangian = "sum(i, 1, 3, i^2*q[i]/(2*i - 1) + i)"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.terms[0].rows(), 3);
  EXPECT_DOUBLE_EQ(value_of(l, {1, 10, 100}, {0, 0, 0}, 0), 1 + 40.0 / 3 + 180 + 6);
  const std::vector<double> uniforms{1, 4.0 / 3, 9.0 / 5, 2, 3};
  EXPECT_EQ(l.uniforms, uniforms);
}

TEST(FormulaGraph, EmptySumsAreZero) {
  const LagrangianGraph l = graph_of(
      {.coordinates = {"q[3]"}, .lagrangian = "q[1]'^2 + sum(i, 4, 3, q[i]) + cos(sum(i, 3, 1, q[i]))"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(value_of(l, {1, 1, 1}, {2, 0, 0}, 0), 5);
  const LagrangianGraph none = graph_of({.coordinates = {"q[3]"}, .lagrangian = "sum(i, 4, 3, q[i])"});
  ASSERT_EQ(none.terms.size(), 1u);
  EXPECT_EQ(none.terms[0].rows(), 1);
  EXPECT_EQ(value_of(none, {1, 1, 1}, {2, 0, 0}, 0), 0);
}

TEST(FormulaGraph, RowsThatReadOneCoordinateTwiceAreFine) {
  const LagrangianGraph l =
      graph_of({.coordinates = {"q[3]"}, .lagrangian = "sum(i, 1, 3, sum(j, 1, 3, q[i]*q[j]'))"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.terms[0].rows(), 9);
  EXPECT_EQ(l.terms[0].arity, 2);
  EXPECT_DOUBLE_EQ(value_of(l, {1, 2, 3}, {4, 5, 6}, 0), 6 * 15);
}

TEST(FormulaGraph, SumsOfConstantsCountTheirRows) {
  EXPECT_EQ(value_of({.coordinates = {"x"}, .lagrangian = "sum(i, 1, 5, 2 + x - x)"}, {3}, {0}), 10);
  EXPECT_EQ(value_of({.coordinates = {"x"}, .lagrangian = "x*sum(i, 1, 5, i)"}, {3}, {0}), 45);
  const LagrangianGraph same = graph_of({.coordinates = {"x"}, .lagrangian = "sum(i, 1, 5, x^2)"});
  EXPECT_EQ(same.terms[0].rows(), 5);
  EXPECT_EQ(value_of(same, {3}, {0}, 0), 45);
}

TEST(FormulaGraph, SumsInsideFunctionsAreWrittenOut) {
  const LagrangianGraph l = graph_of({.coordinates = {"q[3]"}, .lagrangian = "sqrt(sum(i, 1, 3, q[i]^2))"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.terms[0].rows(), 1);
  EXPECT_EQ(value_of(l, {2, 3, 6}, {0, 0, 0}, 0), 7);
  const SystemText product{.coordinates = {"q[3]"}, .lagrangian = "sum(i, 1, 3, q[i])*sum(j, 1, 3, j*q[j])"};
  EXPECT_EQ(value_of(product, {2, 3, 6}, {0, 0, 0}), 11 * 26);
  const SystemText divisor{.coordinates = {"q[3]"}, .lagrangian = "sum(i, 1, 3, i*q[i])/sum(j, 1, 3, q[j])"};
  EXPECT_DOUBLE_EQ(value_of(divisor, {2, 3, 6}, {0, 0, 0}), 26.0 / 11);
}

TEST(FormulaGraph, AWrittenOutSumMayStandInAKernel) {
  const LagrangianGraph l = graph_of(
      {.coordinates = {"q[12]"}, .lagrangian = "sum(i, 1, 4, sqrt(sum(k, 1, 3, q[3*(i - 1) + k]^2)))"});
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.terms[0].rows(), 4);
  EXPECT_EQ(l.terms[0].arity, 3);
  EXPECT_EQ(value_of(l, {2, 3, 6, 1, 2, 2, 1, 4, 8, 2, 10, 11}, std::vector<double>(12), 0), 7 + 3 + 9 + 15);
}

TEST(FormulaGraph, AKernelWhoseRowsDifferInShapeIsWrittenOut) {
  const SystemText text{.coordinates = {"x[4]"},
                        .parameters = {{"m", {{1, 2, 3, 4}, true}}},
                        .lagrangian =
                            "2*sum(i, 1, 4, m[i]*sqrt(sum(j, 1, i - 1, (x[i] - x[j])^2)"
                            " + sum(j, i + 1, 4, (x[i] - x[j])^2)))"};
  const LagrangianGraph l = graph_of(text);
  ASSERT_EQ(l.terms.size(), 1u);
  EXPECT_EQ(l.terms[0].rows(), 1);
  const std::vector<double> x = sample(4, 5);
  double exact = 0;
  for (int i = 0; i < 4; ++i) {
    double density = 0;
    for (int j = 0; j < 4; ++j) density += (x[i] - x[j]) * (x[i] - x[j]);
    exact += 2 * (i + 1) * std::sqrt(density);
  }
  EXPECT_NEAR(value_of(l, x, {0, 0, 0, 0}, 0), exact, 1e-14);
}

TEST(FormulaGraph, FactorsSignsAndDivisorsReachEverySum) {
  const SystemText text{.coordinates = {"x", "q[3]"},
                        .parameters = {{"k", {{3}}}},
                        .definitions = {{"s", "x + sum(i, 1, 3, q[i] - x*sum(j, i, 3, i*j*q[j]^2))"}},
                        .lagrangian = "-(x^2*(1 - s)*k)/(2*cos(x)) - -s/k",
                        .active = {}};
  const double x = 0.3;
  const std::vector<double> q{0.5, -0.7, 1.1};
  double s = x;
  for (int i = 1; i <= 3; ++i) {
    s += q[i - 1];
    for (int j = i; j <= 3; ++j) s -= x * i * j * q[j - 1] * q[j - 1];
  }
  const double exact = -(x * x * (1 - s) * 3) / (2 * std::cos(x)) + s / 3;
  EXPECT_NEAR(value_of(text, {x, 0.5, -0.7, 1.1}, {0, 0, 0, 0}), exact, 1e-14);
  SystemText active = text;
  active.active = {"k"};
  EXPECT_NEAR(value_of(active, {x, 0.5, -0.7, 1.1}, {0, 0, 0, 0}), exact, 1e-14);
  EXPECT_EQ(graph_of(text).terms.size(), 5u);
}

TEST(FormulaGraph, DefinitionsOfTheIndexedSumMeetOuterRows) {
  const SystemText text{.coordinates = {"q[3]"},
                        .definitions = {{"s", "sum(k, 2, 3, k*q[k])"}, {"r", "sqrt(1 + s^2)"}},
                        .lagrangian = "sum(i, 1, 3, i*q[i]*s + q[i]/r)"};
  const double s = 2 * 0.5 + 3 * 0.25, r = std::sqrt(1 + s * s);
  EXPECT_NEAR(value_of(text, {2, 0.5, 0.25}, {0, 0, 0}), 3.75 * s + 2.75 / r, 1e-14);
}

TEST(FormulaGraph, SumsThatAreTooLargeAreRefusedBeforeTheyAreBuilt) {
  const auto refused = [](const std::string& lagrangian) {
    return error_of({.coordinates = {"q[100000]"}, .lagrangian = lagrangian});
  };
  EXPECT_EQ(refused("sum(i, 1, 1e9, q[1])"), "the sum has more than 10000000 terms | lagrangian | 4");
  EXPECT_EQ(refused("sum(i, 1, 1e5, sum(j, 1, 1e5, q[i]*q[j]))"),
            "the sum has more than 10000000 terms | lagrangian | 19");
  EXPECT_EQ(refused("sum(i, 1, 1e5, q[i])^2"), "no error");
  EXPECT_EQ(
      refused("sum(i, 1, 1e5, q[i]*sin(q[i] + cos(q[i])))^2"),
      "a sum inside a function or a product of sums is written out term by term, and here that takes more "
      "than 500000 operations | lagrangian | 24");
  EXPECT_EQ(refused("cos(sum(i, 1, 1e12, 0*q[1]))").substr(0, 34), "a sum inside a function or a produ");
  EXPECT_EQ(refused("sum(i, 1, 9e6, q[1] + q[2] + q[3]*q[4] + q[5] + q[6] + q[7])"),
            "a sum of 9000000 terms that read more than 5 numbers each is too large: 50000000 entries are "
            "the most | "
            "lagrangian | 48");
}

TEST(FormulaGraph, DefinitionsThatDoubleSumsAreRefused) {
  SystemText text{
      .coordinates = {"q[2]"}, .definitions = {{"d0", "sum(i, 1, 2, q[i])"}}, .lagrangian = "d60"};
  for (int k = 1; k <= 60; ++k) {
    const std::string before = name(k - 1);
    text.definitions[name(k)] = before + " + " + before;
  }
  EXPECT_EQ(error_of(text), "more than 10000 sums when definitions are put in | definitions.d0 | 4");
}

TEST(FormulaGraph, AChainOfTenThousandSitesStaysSmall) {
  const LagrangianGraph l = graph_of(
      {.coordinates = {"q[n]"},
       .parameters = {{"n", {{10000}}}, {"beta", {{0.1}}}},
       .lagrangian =
           "sum(i, 1, n, q[i]'^2)/2 - sum(i, 1, n - 1, (q[i+1] - q[i])^2/2 + beta*(q[i+1] - q[i])^4/4)"});
  ASSERT_EQ(l.terms.size(), 2u);
  EXPECT_EQ(l.terms[0].rows(), 10000);
  EXPECT_EQ(l.terms[1].rows(), 9999);
  EXPECT_LT(l.graph.size(), 40u);
}

TEST(FormulaGraph, NumbersThatAreNotFiniteAreRefused) {
  const auto refused = [](const std::string& lagrangian) {
    return error_of({.coordinates = {"q[3]"}, .lagrangian = lagrangian});
  };
  EXPECT_EQ(refused("q[1]/0"), "division by zero | lagrangian | 5");
  EXPECT_EQ(refused("sum(i, 1, 3, q[i]/(i - 2))"), "division by zero | lagrangian | 19");
  EXPECT_EQ(refused("q[1] + log(0)"), "the value is not finite | lagrangian | 7");
  EXPECT_EQ(refused("sum(i, 1, 3, q[i]*(i - 2)^-1)"), "the value is not finite (at i = 2) | lagrangian | 18");
  EXPECT_EQ(refused("q[1]*1e300*1e300"), "the numbers here do not combine to a finite one | lagrangian | 5");
}

}  // namespace
}  // namespace extremal
