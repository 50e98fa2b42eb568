#include "system/expression.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <complex>
#include <vector>

#include "system/expression_evaluate.hpp"

namespace extremal {
namespace {

using Long = boost::multiprecision::cpp_bin_float_50;

double value(const Graph& graph, NodeId f, std::vector<double> inputs) {
  return evaluate(graph, f, std::span<const double>(inputs));
}

class Expression : public testing::Test {
 protected:
  Graph g;
  NodeId x = g.input(0), y = g.input(1);
  NodeId number(double value) { return g.constant(value); }
};

TEST_F(Expression, EqualSubexpressionsAreOneNode) {
  EXPECT_EQ(g.add(x, y), g.add(y, x));
  EXPECT_EQ(g.mul(x, y), g.mul(y, x));
  EXPECT_EQ(g.binary(Op::max, x, y), g.binary(Op::max, y, x));
  EXPECT_NE(g.div(x, y), g.div(y, x));
  EXPECT_NE(g.binary(Op::atan2, x, y), g.binary(Op::atan2, y, x));
  EXPECT_EQ(g.constant(0.0), g.constant(-0.0));
  EXPECT_EQ(g.input(1), y);
}

TEST_F(Expression, NeutralElementsVanish) {
  EXPECT_EQ(g.add(x, number(0)), x);
  EXPECT_EQ(g.sub(x, number(0)), x);
  EXPECT_EQ(g.sub(number(0), x), g.unary(Op::neg, x));
  EXPECT_EQ(g.mul(number(1), x), x);
  EXPECT_EQ(g.mul(x, number(-1)), g.unary(Op::neg, x));
  EXPECT_EQ(g.div(x, number(1)), x);
  EXPECT_EQ(g.mul(x, number(0)), number(0));
  EXPECT_EQ(g.div(number(0), x), number(0));
  EXPECT_EQ(g.sub(x, x), number(0));
  EXPECT_EQ(g.add(x, x), g.mul(number(2), x));
  EXPECT_EQ(g.binary(Op::min, x, x), x);
}

TEST_F(Expression, DivisionsByWhatMayBeZeroStay) {
  EXPECT_TRUE(std::isnan(value(g, g.div(x, x), {0})));
  EXPECT_TRUE(std::isnan(value(g, g.div(number(0), number(0)), {})));
  EXPECT_TRUE(std::isinf(value(g, g.div(number(1), number(0)), {})));
}

TEST_F(Expression, SignsMoveOutwardAndCancel) {
  const NodeId mx = g.unary(Op::neg, x), my = g.unary(Op::neg, y);
  EXPECT_EQ(g.unary(Op::neg, mx), x);
  EXPECT_EQ(g.mul(mx, my), g.mul(x, y));
  EXPECT_EQ(g.div(mx, my), g.div(x, y));
  EXPECT_EQ(g.add(x, my), g.sub(x, y));
  EXPECT_EQ(g.sub(x, my), g.add(x, y));
  EXPECT_EQ(g.unary(Op::cos, mx), g.unary(Op::cos, x));
  EXPECT_EQ(g.unary(Op::sin, mx), g.unary(Op::neg, g.unary(Op::sin, x)));
  EXPECT_EQ(g.unary(Op::cos, g.sub(x, y)), g.unary(Op::cos, g.sub(y, x)));
}

TEST_F(Expression, ConstantsFold) {
  EXPECT_TRUE(g.is_constant(g.unary(Op::sin, number(0.5)), std::sin(0.5)));
  EXPECT_TRUE(g.is_constant(g.pow(number(2), number(0.3)), std::pow(2, 0.3)));
  EXPECT_TRUE(g.is_constant(g.div(number(1), number(3)), 1.0 / 3));
  EXPECT_EQ(g.mul(number(2), g.mul(number(3), x)), g.mul(number(6), x));
  EXPECT_EQ(g.div(g.mul(number(3), x), number(3)), x);
  EXPECT_EQ(g.add(number(2), g.add(x, number(3))), g.add(number(5), x));
}

TEST_F(Expression, InexactConstantsDoNotMerge) {
  const NodeId f = g.mul(number(0.1), g.mul(number(0.3), x));
  const std::array<Long, 1> one{Long(1)};
  EXPECT_EQ(evaluate(g, f, std::span<const Long>(one)), Long(0.1) * Long(0.3));
  const NodeId third = g.div(x, number(3));
  EXPECT_EQ(evaluate(g, third, std::span<const Long>(one)), Long(1) / 3);
  const NodeId tiny = g.mul(number(1e-200), g.mul(number(1e-200), x));
  EXPECT_DOUBLE_EQ(value(g, tiny, {1e250}), 1e-150);
}

TEST_F(Expression, PowersBecomeProducts) {
  for (int twice = -32; twice <= 32; ++twice) {
    const NodeId f = g.pow(x, number(0.5 * twice));
    for (const NodeId id : nodes_of(g, f)) EXPECT_NE(g[id].op, Op::pow) << twice;
    for (const double at : {0.3, 1.7, 4.2}) {
      const double exact = std::pow(at, 0.5 * twice);
      EXPECT_NEAR(value(g, f, {at}), exact, 8e-16 * std::max(1, std::abs(twice) / 4) * exact) << twice;
    }
    if (twice % 2 == 0) {
      EXPECT_NEAR(value(g, f, {-1.5}) / std::pow(-1.5, twice / 2), 1, 4e-15) << twice;
    }
  }
  EXPECT_EQ(g.pow(x, number(0)), number(1));
  EXPECT_EQ(g.pow(x, number(1)), x);
  EXPECT_EQ(g.pow(x, number(4)), g.mul(g.pow(x, number(2)), g.pow(x, number(2))));
  EXPECT_EQ(g[g.pow(x, number(17))].op, Op::pow);
  EXPECT_EQ(g[g.pow(x, number(1.0 / 3))].op, Op::pow);
  EXPECT_EQ(g[g.pow(x, number(-3))].op, Op::div);
}

TEST_F(Expression, AllOperationsHaveTheValuesOfTheStandardLibrary) {
  const double a = 0.6, b = -0.35;
  const auto one = [&](Op op) { return value(g, g.unary(op, x), {a}); };
  const auto two = [&](Op op) { return value(g, g.binary(op, x, y), {a, b}); };
  EXPECT_EQ(one(Op::neg), -a);
  EXPECT_EQ(value(g, g.unary(Op::abs, y), {a, b}), -b);
  EXPECT_EQ(one(Op::sqrt), std::sqrt(a));
  EXPECT_EQ(one(Op::exp), std::exp(a));
  EXPECT_EQ(one(Op::log), std::log(a));
  EXPECT_EQ(one(Op::sin), std::sin(a));
  EXPECT_EQ(one(Op::cos), std::cos(a));
  EXPECT_EQ(one(Op::tan), std::tan(a));
  EXPECT_EQ(one(Op::asin), std::asin(a));
  EXPECT_EQ(one(Op::acos), std::acos(a));
  EXPECT_EQ(one(Op::atan), std::atan(a));
  EXPECT_EQ(one(Op::sinh), std::sinh(a));
  EXPECT_EQ(one(Op::cosh), std::cosh(a));
  EXPECT_EQ(one(Op::tanh), std::tanh(a));
  EXPECT_EQ(two(Op::add), a + b);
  EXPECT_EQ(two(Op::sub), a - b);
  EXPECT_EQ(two(Op::mul), a * b);
  EXPECT_EQ(two(Op::div), a / b);
  EXPECT_EQ(two(Op::pow), std::pow(a, b));
  EXPECT_EQ(two(Op::atan2), std::atan2(a, b));
  EXPECT_EQ(two(Op::min), b);
  EXPECT_EQ(two(Op::max), a);
  EXPECT_EQ(two(Op::step), 1);
  EXPECT_EQ(value(g, g.binary(Op::step, x, y), {b, a}), 0);
  EXPECT_EQ(value(g, g.binary(Op::step, x, y), {a, a}), 1);
}

TEST_F(Expression, ComplexStepDifferentiatesEveryOperation) {
  using Complex = std::complex<double>;
  const double h = 1e-200;
  const auto slope = [&](NodeId f, double a, double b) {
    const std::array<Complex, 2> at{Complex(a, h), Complex(b, 0)};
    return evaluate(g, f, std::span<const Complex>(at)).imag() / h;
  };
  for (const double a : {0.6, -0.6})
    for (const double b : {0.35, -0.35, 0.9, -0.9}) {
      EXPECT_NEAR(slope(g.binary(Op::atan2, x, y), a, b), b / (a * a + b * b), 1e-15);
      EXPECT_NEAR(slope(g.binary(Op::atan2, y, x), a, b), -b / (a * a + b * b), 1e-15);
      const std::array<Complex, 2> at{Complex(a), Complex(b)};
      EXPECT_NEAR(evaluate(g, g.binary(Op::atan2, x, y), std::span<const Complex>(at)).real(),
                  std::atan2(a, b), 5e-16);
      EXPECT_EQ(slope(g.binary(Op::max, x, y), a, b), a > b ? 1 : 0);
      EXPECT_EQ(slope(g.binary(Op::min, x, y), a, b), a < b ? 1 : 0);
      EXPECT_EQ(slope(g.unary(Op::abs, x), a, b), a > 0 ? 1 : -1);
      EXPECT_NEAR(slope(g.pow(x, number(20)), a, b) / (20 * std::pow(a, 19)), 1, 1e-14);
      EXPECT_NEAR(slope(g.pow(x, number(-20)), a, b) / (-20 * std::pow(a, -21)), 1, 1e-14);
    }
}

TEST_F(Expression, ExtendedPrecisionCarriesItsDigits) {
  const NodeId f = g.unary(Op::sin, g.div(x, g.unary(Op::sqrt, y)));
  const std::array<Long, 2> at{Long(1), Long(2)};
  const Long exact("0.649636939080062444129478616044121910899028817964577910840238");
  EXPECT_LT(abs(evaluate(g, f, std::span<const Long>(at)) - exact), Long("1e-48"));
  const std::array<long double, 2> wide{1.0L, 2.0L};
  EXPECT_NEAR(static_cast<double>(evaluate(g, f, std::span<const long double>(wide)) -
                                  exact.convert_to<long double>()),
              0, 1e-18);
}

TEST_F(Expression, InputsOfNamesWhatIsReached) {
  const NodeId f = g.mul(g.input(7), g.add(x, g.input(3)));
  g.mul(f, y);
  EXPECT_EQ(inputs_of(g, f), (std::vector<std::uint32_t>{0, 3, 7}));
  EXPECT_TRUE(inputs_of(g, number(2)).empty());
}

TEST_F(Expression, NodesOfListsArgumentsFirst) {
  const NodeId unused = g.unary(Op::exp, y), f = g.mul(g.unary(Op::sin, x), g.add(x, number(2)));
  const std::vector<NodeId> nodes = nodes_of(g, f);
  EXPECT_EQ(nodes.size(), 5u);
  EXPECT_EQ(nodes.back(), f);
  for (std::size_t i = 1; i < nodes.size(); ++i) EXPECT_LT(nodes[i - 1], nodes[i]);
  for (const NodeId id : nodes) EXPECT_NE(id, unused);
}

TEST_F(Expression, SubstituteRebuildsAndFolds) {
  const NodeId f = g.add(g.mul(x, y), g.unary(Op::cos, x));
  const std::array<NodeId, 2> swap{y, x};
  EXPECT_EQ(substitute(g, f, swap), g.add(g.mul(x, y), g.unary(Op::cos, y)));
  const std::array<NodeId, 2> fixed{number(0), y};
  EXPECT_EQ(substitute(g, f, fixed), number(1));
  const std::array<NodeId, 1> missing{x};
  try {
    substitute(g, f, missing);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "input 1 has no replacement among 1");
  }
}

TEST_F(Expression, RepeatedBuildingAddsNoNode) {
  const auto build = [&] {
    NodeId f = number(0);
    for (std::uint32_t i = 0; i < 20000; ++i)
      f = g.add(f, g.pow(g.sub(g.input(i + 1), g.input(i)), number(3)));
    return f;
  };
  const NodeId first = build();
  const std::size_t size = g.size();
  EXPECT_EQ(build(), first);
  EXPECT_EQ(g.size(), size);
  EXPECT_EQ(inputs_of(g, first).size(), 20001u);
}

}  // namespace
}  // namespace extremal
