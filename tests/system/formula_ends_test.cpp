#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formula_support.hpp"

namespace extremal {
namespace {

Vocabulary plane() {
  Vocabulary plane({{"a", {{2}}}, {"m", {{3, 5}, true}}},
                   {{"s", "x^2 + q[2]"}, {"c", "2*a"}, {"u", "x'"}, {"wave", "sin(t)"}, {"half", "x/2"}});
  plane.coordinates = {{"x", 0, 1, false}, {"q", 1, 2, true}};
  return plane;
}

std::vector<double> dense(const std::vector<Triplet>& triplets, int size) {
  std::vector<double> row(size);
  for (const Triplet& t : triplets) {
    EXPECT_EQ(t.row, 0);
    row.at(t.column) += t.value;
  }
  return row;
}

TEST(FormulaEnds, AffineEquationsAreRecognised) {
  const Vocabulary system = plane();
  const EndEquation equation = end_equation("x(0) - a*q[2](T)/4 = m[1] + q[1](0)", system, "conditions[0]");
  EXPECT_TRUE(equation.affine);
  EXPECT_EQ(dense(equation.coefficients, 6), (std::vector<double>{1, -1, 0, 0, 0, -0.5}));
  EXPECT_EQ(equation.constant, -3);
  const std::vector<double> start{1, 2, 3}, end{4, 5, 6};
  std::vector<double> gradient(6, 99);
  EXPECT_EQ(equation.function(start, end, gradient), 1 - 2 - 3 - 3);
  EXPECT_EQ(gradient, (std::vector<double>{1, -1, 0, 0, 0, -0.5}));
  EXPECT_EQ(equation.function(start, end, {}), -7);
}

TEST(FormulaEnds, AffineEquationsHideInProductsAndSums) {
  const Vocabulary system = plane();
  const EndEquation equation =
      end_equation("2*(x(0) + 3*(x(T) - 1))/5 = sum(i, 1, 2, m[i]*q[i](T))", system, "where");
  EXPECT_TRUE(equation.affine);
  const std::vector<double> row = dense(equation.coefficients, 6);
  const std::vector<double> exact{0.4, 0, 0, 1.2, -3, -5};
  for (int e = 0; e < 6; ++e) EXPECT_DOUBLE_EQ(row[e], exact[e]);
  EXPECT_DOUBLE_EQ(equation.constant, -1.2);
}

TEST(FormulaEnds, OtherEquationsAreFunctionsWithAGradient) {
  const Vocabulary system = plane();
  const EndEquation equation = end_equation("sin(x(0))*q[1](T)^2 = exp(q[2](0))", system, "where");
  EXPECT_FALSE(equation.affine);
  EXPECT_TRUE(equation.coefficients.empty());
  const std::vector<double> start{0.5, 7, 0.25}, end{8, 3, 9};
  std::vector<double> gradient(6, 99);
  EXPECT_DOUBLE_EQ(equation.function(start, end, gradient), std::sin(0.5) * 9 - std::exp(0.25));
  EXPECT_DOUBLE_EQ(gradient[0], std::cos(0.5) * 9);
  EXPECT_DOUBLE_EQ(gradient[2], -std::exp(0.25));
  EXPECT_DOUBLE_EQ(gradient[4], std::sin(0.5) * 6);
  for (const int e : {1, 3, 5}) EXPECT_EQ(gradient[e], 0);
}

TEST(FormulaEnds, MalformedEquationsAreRefused) {
  const Vocabulary system = plane();
  const auto refused = [&](const std::string& text) {
    return error_of([&] { end_equation(text, system, "where"); });
  };
  EXPECT_EQ(refused("x(0)"), "'=' is missing: write left = right | where | 4");
  EXPECT_EQ(refused("x(0) = 1 = 2"), "a second '='; an equation has one | where | 9");
  EXPECT_EQ(refused("x(0) == 1"), "a second '='; an equation has one | where | 6");
  EXPECT_EQ(refused("x = 1"), "write x(0) or x(T): a condition holds between end values | where | 0");
  EXPECT_EQ(refused("q[1] = 1"),
            "write q[1](0) or q[1](T): a condition holds between end values | where | 0");
  EXPECT_EQ(refused("q(0) = 1"), "'q' has 2 elements; write q[1] … q[2] | where | 0");
  EXPECT_EQ(refused("x[1](0) = 1"), "'x' is a coordinate without elements; write x | where | 0");
  EXPECT_EQ(refused("q[3](0) = 1"), "q[3] is out of range: 'q' has 2 elements, counted from 1 | where | 0");
  EXPECT_EQ(refused("x(1) = 1"), "write x(0) or x(T) for the value at an end | where | 0");
  EXPECT_EQ(refused("x(t) = 1"), "write x(0) or x(T) for the value at an end | where | 0");
  EXPECT_EQ(refused("x(0, T) = 1"), "write x(0) or x(T) for the value at an end | where | 0");
  EXPECT_EQ(refused("x'(0) = 1"),
            "\"x'\" is a velocity; conditions hold between coordinates; a momentum is given in 'start' or "
            "'end': start = { p_x = … } | where | 0");
  EXPECT_EQ(refused("x(0) = T"),
            "unknown name 'T'; T is the duration only in a guess, and in x(T) in a condition | where | 7");
  EXPECT_EQ(refused("x(0) = t"), "unknown name 't'; the time cannot stand here | where | 7");
  EXPECT_EQ(refused("1 = 2"), "the equation depends on no end value; write x(0) or x(T) | where | 0");
  EXPECT_EQ(refused("x(0) = x(0)"), "the equation depends on no end value; write x(0) or x(T) | where | 0");
  EXPECT_EQ(refused("sine(x(0)) = 1"), "unknown function 'sine'; did you mean 'sin'? | where | 0");
  EXPECT_EQ(
      refused("p_x(T) = 1"),
      "unknown function 'p_x'; conditions hold between coordinates; a momentum is given in 'start' or 'end': "
      "start = { p_x = … } | where | 0");
}

TEST(FormulaEnds, MapsAreAffineInTheCoordinates) {
  const Vocabulary system = plane();
  const AffineForm form = affine_form("-x + a*q[2] + 2*pi", system, "map.x");
  EXPECT_EQ(dense(form.coefficients, 3), (std::vector<double>{-1, 0, 2}));
  EXPECT_DOUBLE_EQ(form.constant, 2 * M_PI);
  const AffineForm constant = affine_form("3", system, "map.x");
  EXPECT_TRUE(constant.coefficients.empty());
  EXPECT_EQ(constant.constant, 3);
  const auto refused = [&](const std::string& text) {
    return error_of([&] { affine_form(text, system, "map.x"); });
  };
  EXPECT_EQ(refused("x*q[1]"),
            "a map is affine in the coordinates: sums of coordinates with constant factors, and a constant | "
            "map.x | 0");
  EXPECT_EQ(refused("x'"), "\"x'\" is a velocity; a map is made of coordinates | map.x | 0");
  EXPECT_EQ(refused("x(0)"), "'x' is a coordinate, not a function; write x*(…) to multiply | map.x | 0");
  EXPECT_EQ(refused("y"),
            "unknown name 'y'; is it a parameter that is not declared? Declared: a, m | map.x | 0");
}

TEST(FormulaEnds, DefinitionsHaveValuesAtTheEnds) {
  const Vocabulary system = plane();
  const EndEquation equation = end_equation("s(T) - s(0) = c*x(0)", system, "where");
  EXPECT_FALSE(equation.affine);
  const std::vector<double> start{1, 2, 3}, end{4, 5, 6};
  std::vector<double> gradient(6, 99);
  EXPECT_EQ(equation.function(start, end, gradient), (16 + 6) - (1 + 3) - 4);
  EXPECT_EQ(gradient, (std::vector<double>{-2 - 4, 0, -1, 8, 0, 1}));
  EXPECT_TRUE(end_equation("half(T) = c", system, "conditions").affine);
  EXPECT_EQ(end_equation("x(T) = c(0)", system, "conditions").constant, -4);
  const auto refused = [&](const std::string& text) {
    return error_of([&] { end_equation(text, system, "where"); });
  };
  EXPECT_EQ(refused("s = 1"), "write s(0) or s(T): a condition holds between end values | where | 0");
  EXPECT_EQ(refused("s(1) = 1"), "write s(0) or s(T) for the value at an end | where | 0");
  EXPECT_EQ(refused("u(0) = 1"),
            "the definition 'u' depends on velocities; conditions hold between coordinates | where | 0");
  EXPECT_EQ(refused("wave(0) = x(0)"),
            "the definition 'wave' depends on t; conditions hold between coordinates | where | 0");
}

TEST(FormulaEnds, MapsUseDefinitionsAndTheIndex) {
  const Vocabulary system = plane();
  EXPECT_EQ(dense(affine_form("c*half + q[3 - i]", system, "map", 1).coefficients, 3),
            (std::vector<double>{2, 0, 1}));
  EXPECT_EQ(error_of([&] { affine_form("u", system, "map"); }),
            "the definition 'u' depends on velocities, which cannot stand here | map | 0");
}

}  // namespace
}  // namespace extremal
