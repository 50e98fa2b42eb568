#include <gtest/gtest.h>

#include <chrono>
#include <complex>
#include <random>

#include "system/derivative.hpp"
#include "system/oracle.hpp"

namespace extremal {
namespace {

using oracle::Long;

/// One operation of two inputs, wrapped so that its derivatives are not those of the operation alone.
struct Case {
  Op op;
  double x, y;
};

class EveryOperation : public testing::TestWithParam<Case> {
 protected:
  Graph g;
  std::vector<std::uint32_t> inputs = {0, 1};

  NodeId function() {
    const auto [op, x, y] = GetParam();
    const NodeId a = g.mul(g.input(0), g.input(0)), b = g.sub(g.input(1), g.input(0));
    const NodeId f = arity(op) == 2 ? g.binary(op, a, b) : g.unary(op, g.mul(a, b));
    return g.add(g.mul(f, f), g.mul(f, g.input(1)));
  }
  auto differences(NodeId f) {
    const auto value = [this, f](const std::vector<Long>& z) {
      return evaluate(g, f, std::span<const Long>(z));
    };
    return oracle::Differences<decltype(value)>(value, {Long(GetParam().x), Long(GetParam().y)});
  }
  Long value(NodeId f) {
    const std::vector<Long> z = {Long(GetParam().x), Long(GetParam().y)};
    return evaluate(g, f, std::span<const Long>(z));
  }
};

TEST_P(EveryOperation, GradientAndHessianAreTheDifferences) {
  const NodeId f = function();
  auto exact = differences(f);
  const std::vector<NodeId> first = gradient(g, f, inputs);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_NEAR(double(value(first[j]) - exact.first(j)), 0, 1e-13 * (1 + std::abs(double(exact.first(j)))))
        << j;
    const std::vector<NodeId> second = gradient(g, first[j], inputs);
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(double(value(second[k]) - exact.second(j, k)), 0,
                  1e-13 * (1 + std::abs(double(exact.second(j, k)))))
          << j << " " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Operations, EveryOperation,
    testing::Values(Case{Op::add, 0.7, 1.1}, Case{Op::sub, 0.7, 1.1}, Case{Op::mul, 0.7, 1.1},
                    Case{Op::div, 0.7, 1.1}, Case{Op::pow, 0.7, 1.1}, Case{Op::pow, 1.2, -2.1},
                    Case{Op::atan2, 0.7, 1.1}, Case{Op::atan2, 0.7, -1.1}, Case{Op::min, 0.7, 1.1},
                    Case{Op::min, 0.7, 3.1}, Case{Op::max, 0.7, 1.1}, Case{Op::max, 0.7, 3.1},
                    Case{Op::step, 0.7, 1.1}, Case{Op::neg, 0.7, 1.1}, Case{Op::abs, 0.7, 1.1},
                    Case{Op::abs, 0.7, -1.1}, Case{Op::sqrt, 0.7, 1.1}, Case{Op::exp, 0.7, 1.1},
                    Case{Op::log, 0.7, 1.1}, Case{Op::sin, 0.7, 1.1}, Case{Op::cos, 0.7, 1.1},
                    Case{Op::tan, 0.7, 1.1}, Case{Op::asin, 0.7, 1.1}, Case{Op::acos, 0.7, 1.1},
                    Case{Op::atan, 0.7, 1.1}, Case{Op::sinh, 0.7, 1.1}, Case{Op::cosh, 0.7, -1.1},
                    Case{Op::tanh, 0.7, 1.1}));

class Derivative : public testing::Test {
 protected:
  Graph g;
  NodeId x = g.input(0), y = g.input(1);
  std::vector<NodeId> gradient_xy(NodeId f) { return gradient(g, f, std::vector<std::uint32_t>{0, 1}); }
};

TEST_F(Derivative, OfPowersIsTheSameNodeHoweverItArises) {
  // d(r⁻³)/dx = −3 x r⁻⁵ from three spellings of r⁻³.
  const NodeId s = g.add(g.mul(x, x), g.mul(y, y)), r = g.unary(Op::sqrt, s);
  const NodeId first = gradient_xy(g.div(g.constant(1), g.pow(r, g.constant(3))))[0];
  EXPECT_EQ(gradient_xy(g.div(g.constant(1), g.mul(s, r)))[0], first);
  EXPECT_EQ(gradient_xy(g.pow(s, g.constant(-1.5)))[0], first);
}

TEST_F(Derivative, SecondDerivativesCommute) {
  const NodeId f = g.div(g.mul(x, g.unary(Op::sin, y)), g.unary(Op::sqrt, g.add(g.mul(x, x), g.mul(y, y))));
  const std::vector<NodeId> first = gradient_xy(f);
  const std::vector<double> point = {0.3, 0.8};
  EXPECT_NEAR(evaluate(g, gradient_xy(first[0])[1], std::span<const double>(point)),
              evaluate(g, gradient_xy(first[1])[0], std::span<const double>(point)), 1e-15);
}

TEST_F(Derivative, VanishesWhereNothingDepends) {
  EXPECT_TRUE(g.is_constant(gradient_xy(g.unary(Op::sin, x))[1], 0));
  EXPECT_TRUE(g.is_constant(gradient_xy(g.sub(g.mul(x, y), g.mul(y, x)))[0], 0));
  EXPECT_TRUE(g.is_constant(gradient_xy(g.constant(3))[0], 0));
}

TEST_F(Derivative, OfQuadraticFormsAreNumbers) {
  // ½(x − y)² + 2xy has the Hessian ((1, 1), (1, 1)).
  const NodeId d = g.sub(x, y);
  const NodeId f = g.add(g.div(g.mul(d, d), g.constant(2)), g.mul(g.constant(2), g.mul(x, y)));
  for (const NodeId row : gradient_xy(f))
    for (const NodeId entry : gradient_xy(row)) EXPECT_TRUE(g.is_constant(entry, 1));
}

TEST_F(Derivative, OfPowersIsFiniteWhereTheBaseVanishes) {
  const NodeId slope = gradient_xy(g.pow(x, g.constant(2.3)))[0];
  const std::vector<double> origin = {0, 0};
  EXPECT_EQ(evaluate(g, slope, std::span<const double>(origin)), 0);
}

TEST_F(Derivative, AgreesWithAComplexStep) {
  const NodeId f = g.mul(g.unary(Op::exp, g.mul(x, y)), g.pow(g.add(x, g.constant(2)), g.constant(-2.5)));
  const std::vector<std::complex<double>> stepped = {{0.4, 1e-30}, {0.9, 0}};
  const double exact = evaluate(g, f, std::span<const std::complex<double>>(stepped)).imag() / 1e-30;
  const std::vector<double> point = {0.4, 0.9};
  EXPECT_NEAR(evaluate(g, gradient_xy(f)[0], std::span<const double>(point)), exact, 4e-16);
}

TEST_F(Derivative, OfLongProductsAndDeepSumsNeedsNoStack) {
  NodeId f = x;
  for (int k = 0; k < 200000; ++k) f = g.add(g.unary(Op::sin, f), y);
  EXPECT_EQ(gradient_xy(f).size(), 2u);
  NodeId product = g.input(0);
  std::vector<std::uint32_t> inputs = {0};
  for (std::uint32_t k = 1; k < 2000; ++k) {
    product = g.mul(product, g.input(k));
    inputs.push_back(k);
  }
  const std::size_t before = g.size();
  const std::vector<NodeId> partials = gradient(g, product, inputs);
  EXPECT_LT(g.size() - before, 40u * inputs.size());
  const std::vector<double> ones(2000, 1.0);
  EXPECT_EQ(evaluate(g, partials[1234], std::span<const double>(ones)), 1);
}

/// x · x · … and its kind: a power takes the time of its logarithm, however it was written.
TEST(Gradient, LongProductsTakeTimeThatGrowsLikeTheirLength) {
  const auto nodes = [](int factors) {
    Graph g;
    const NodeId x = g.input(0), root = g.unary(Op::sqrt, g.add(x, g.constant(1)));
    NodeId product = x, quotient = g.constant(1), roots = root;
    for (int k = 1; k < factors; ++k) {
      product = g.mul(product, x);
      quotient = g.div(quotient, g.add(x, g.constant(2)));
      roots = g.mul(roots, root);
    }
    const std::vector<std::uint32_t> inputs = {0};
    const NodeId slope = gradient(g, g.add(g.add(product, quotient), roots), inputs)[0];
    gradient(g, slope, inputs);
    return static_cast<double>(g.size());
  };
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_LT(nodes(20000) / nodes(10000), 2.5);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

}  // namespace
}  // namespace extremal
