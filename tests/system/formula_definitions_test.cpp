#include <gtest/gtest.h>

#include <cmath>

#include "formula_support.hpp"

/// \file Definitions with velocities, and parameters that are formulas.

namespace extremal {
namespace {

using Parameters = std::map<std::string, ParameterEntry>;

TEST(FormulaDefinitions, HaveAVelocity) {
  const SystemText text{.coordinates = {"a"},
                        .parameters = {{"l", {{2}}}},
                        .definitions = {{"X", "l*sin(a) + t^2"}, {"Y", "-l*cos(a)"}},
                        .lagrangian = "(X'^2 + Y'^2)/2"};
  const double a = 0.3, v = 0.7, t = 1.5, x = 2 * std::cos(a) * v + 2 * t, y = 2 * std::sin(a) * v;
  EXPECT_NEAR(value_of(text, {a}, {v}, t), (x * x + y * y) / 2, 1e-14);
}

TEST(FormulaDefinitions, VelocitiesOfSumsAndOfDefinitionsOfDefinitions) {
  const SystemText text{.coordinates = {"q[3]"},
                        .definitions = {{"X", "sum(i, 1, 3, i*q[i]^2)"}, {"Z", "exp(X)*q[1]"}, {"two", "2"}},
                        .lagrangian = "X' + sum(k, 1, 2, k*Z')*X'^2 + two'"};
  const std::vector<double> q{0.1, -0.2, 0.3}, v{1, 2, -1};
  double x = 0, dx = 0;
  for (int i = 0; i < 3; ++i) {
    x += (i + 1) * q[i] * q[i];
    dx += 2 * (i + 1) * q[i] * v[i];
  }
  const double dz = std::exp(x) * (dx * q[0] + v[0]);
  EXPECT_NEAR(value_of(text, q, v), dx + 3 * dz * dx * dx, 1e-13);
}

TEST(FormulaDefinitions, AreNumbersWhereNumbersStand) {
  const Vocabulary vocabulary(
      {{"l", {{2}}}, {"g", {{8}}}},
      {{"omega", "sqrt(g/l)"}, {"period", "2*pi/omega"}, {"T", "3*l"}, {"decay", "exp(-t/l)"}});
  EXPECT_DOUBLE_EQ(number("period/2 + i", vocabulary, "duration", 3), std::acos(-1.0) / 2 + 3);
  EXPECT_DOUBLE_EQ(number("T", vocabulary, "duration"), 6);
  const std::vector<double> times{0, 1, 3};
  const std::vector<double> found =
      tabulate("decay*T", vocabulary, 5, times, 0, "guess");  // T is the duration
  for (int k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(found[k], 5 * std::exp(-times[k] / 2));
  EXPECT_EQ(error_of([&] { number("decay", vocabulary, "duration"); }),
            "the definition 'decay' depends on t, which cannot stand here | duration | 0");
}

TEST(FormulaDefinitions, ThoseOfCoordinatesAreNoNumbers) {
  Vocabulary vocabulary({}, {{"r", "sqrt(x^2)"}});
  vocabulary.coordinates = {{"x"}};
  EXPECT_EQ(error_of([&] { number("2*r", vocabulary, "duration"); }),
            "the definition 'r' depends on coordinates, which cannot stand here | duration | 2");
}

TEST(FormulaDefinitions, CountElements) {
  const SystemText text{.coordinates = {"q[n]"},
                        .parameters = {{"m", {{2}}}},
                        .definitions = {{"n", "2*m"}},
                        .lagrangian = "sum(i, 1, n, q[i]'^2)"};
  EXPECT_EQ(value_of(text, {0, 0, 0, 0}, {1, 2, 3, 4}), 30);
}

TEST(FormulaParameters, AreEvaluatedByDependence) {
  const auto values = evaluate_parameters(
      Parameters{{"a", {{"2*b + m[2]"}}}, {"b", {{"half"}}}, {"c", {{3.0}}}, {"m", {{1.0, "c^2"}, true}}},
      {{"half", "c/2"}, {"unused", "nothing(1)"}});
  EXPECT_EQ(values.at("a").value, Parameter{12});
  EXPECT_EQ(values.at("b").value, Parameter{1.5});
  EXPECT_EQ(values.at("m").value, (Parameter{1, 9}));
  EXPECT_TRUE(values.at("m").list);
}

TEST(FormulaParameters, CyclesAndUnknownNamesAreNamed) {
  const auto refused = [](const Parameters& parameters,
                          const std::map<std::string, std::string>& definitions = {}) {
    return error_of([&] { evaluate_parameters(parameters, definitions); });
  };
  EXPECT_EQ(refused({{"a", {{"2*b"}}}, {"b", {{"c + 1"}}}, {"c", {{"a"}}}}),
            "parameters form a cycle: a -> b -> c -> a | parameters.c[1] | 0");
  EXPECT_EQ(refused({{"a", {{"2*d"}}}}, {{"d", "1 + a"}}),
            "parameters form a cycle: a -> d -> a | definitions.d | 4");
  EXPECT_EQ(refused({{"m", {{1.0, "2*mu"}, true}}, {"nu", {{1.0}}}}).substr(0, 17), "unknown name 'mu'");
  EXPECT_EQ(refused({{"a", {{"1/0"}}}}), "the value is not finite | parameters.a[1] | 0");
}

TEST(FormulaNamesIn, AreThoseOfTheText) {
  EXPECT_EQ(names_in("2*mu/r + sum(i, 1, n, m[i]*x[i]')"),
            (std::set<std::string>{"mu", "r", "sum", "i", "n", "m", "x"}));
  EXPECT_EQ(names_in("a + § b"), std::set<std::string>{"a"});
}

TEST(NearestName, CapitalsCountForNothing) {
  const std::vector<std::string> known{"g", "l"};
  EXPECT_EQ(nearest_name("G", known), "g");
  EXPECT_EQ(nearest_name("k", known), "");
}

}  // namespace
}  // namespace extremal
