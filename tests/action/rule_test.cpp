#include "action/rule.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "action/real_rule.hpp"

namespace extremal {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// ∫₀¹ P_k(2τ − 1) by the rule: 1 for k = 0 and 0 for each other k that it is exact for.
long double integral_of_legendre(const Rule& rule, int k) {
  long double sum = 0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    sum += rule.weights[i] * std::legendre(k, 2 * static_cast<long double>(rule.nodes[i]) - 1);
  return sum;
}

void expect_exact_to(const Rule& rule, int degree) {
  for (int k = 0; k <= degree; ++k)
    EXPECT_NEAR(static_cast<double>(integral_of_legendre(rule, k)), k == 0, 2e-15)
        << rule.nodes.size() << " points, P_" << k;
  EXPECT_GT(std::abs(integral_of_legendre(rule, degree + 1)), 1e-3) << rule.nodes.size() << " points";
}

TEST(Rule, ExactToItsDegreeAndNoFurther) {
  for (int points = 1; points <= 32; ++points) expect_exact_to(gauss_rule(points), 2 * points - 1);
  for (int points = 2; points <= 32; ++points) expect_exact_to(lobatto_rule(points), 2 * points - 3);
}

/// Moments Σ_i w_i τ_i^k = 1/(k + 1) of rules with 106 bits.
TEST(Rule, HasTheDigitsOfTwoDoubles) {
  const auto expect_moments = [](const RealRule& rule, int degree) {
    std::vector<Real> terms = rule.weights;
    for (int k = 0; k <= degree; ++k) {
      Real sum = 0;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        sum += terms[i];
        terms[i] *= rule.nodes[i].left;
      }
      EXPECT_LT(std::abs(to_double(sum - Real(1) / (k + 1))), 1e-30)
          << rule.nodes.size() << " points, power " << k;
    }
  };
  for (int points = 2; points <= 24; ++points) {
    expect_moments(real_gauss(points), 2 * points - 1);
    expect_moments(real_lobatto(points), 2 * points - 3);
  }
}

TEST(Rule, MirrorSymmetricToTheLastBit) {
  for (int points = 2; points <= max_points; ++points)
    for (const Rule& rule : {gauss_rule(points), lobatto_rule(points)})
      for (int i = 0; i < points; ++i) {
        const int mirror = points - 1 - i;
        EXPECT_EQ(rule.weights[i], rule.weights[mirror]);
        if (mirror >= i) {
          EXPECT_EQ(rule.nodes[mirror], 1 - rule.nodes[i]);
        }
        if (i > 0) {
          EXPECT_GT(rule.nodes[i], rule.nodes[i - 1]);
        }
      }
}

/// P_n, P_n' and P_n'' at x, in quadruple precision.
struct Polynomial {
  Quad value, first, second;
};
Polynomial legendre(int n, const Quad& x) {
  Quad previous = 1, value = x;
  for (int k = 1; k < n; ++k) {
    const Quad next = ((2 * k + 1) * x * value - k * previous) / (k + 1);
    previous = value;
    value = next;
  }
  if (n == 0) return {1, 0, 0};
  const Quad first = n * (previous - x * value) / (1 - x * x);
  return {value, first, (2 * x * first - Quad(n) * (n + 1) * value) / (1 - x * x)};
}

/// Within an ulp: |a − exact| <= the distance from a to its neighbour.
void expect_one_ulp(double a, const Quad& exact, const char* what, int points, int i) {
  const double ulp = std::nextafter(a, 2.0) - a;
  EXPECT_LE(static_cast<double>(abs(Quad(a) - exact)), ulp) << what << " " << i << " of " << points;
}

TEST(Rule, GaussCorrectToOneUlp) {
  for (int n = 1; n <= 32; ++n) {
    const Rule rule = gauss_rule(n);
    for (int i = 0; i < n; ++i) {
      Quad x = 2 * Quad(rule.nodes[i]) - 1;
      for (int k = 0; k < 3; ++k) x -= legendre(n, x).value / legendre(n, x).first;
      const Quad slope = legendre(n, x).first;
      expect_one_ulp(rule.nodes[i], (1 + x) / 2, "node", n, i);
      expect_one_ulp(rule.weights[i], 1 / ((1 - x * x) * slope * slope), "weight", n, i);
    }
  }
}

TEST(Rule, LobattoCorrectToOneUlp) {
  for (int points = 3; points <= 32; ++points) {
    const Rule rule = lobatto_rule(points);
    const int n = points - 1;
    for (int i = 1; i < n; ++i) {
      Quad x = 2 * Quad(rule.nodes[i]) - 1;
      for (int k = 0; k < 3; ++k) x -= legendre(n, x).first / legendre(n, x).second;
      const Quad value = legendre(n, x).value;
      expect_one_ulp(rule.nodes[i], (1 + x) / 2, "node", points, i);
      expect_one_ulp(rule.weights[i], 1 / (Quad(n) * points * value * value), "weight", points, i);
    }
  }
}

TEST(Rule, LobattoClosedForms) {
  const Rule four = lobatto_rule(4), five = lobatto_rule(5);
  EXPECT_DOUBLE_EQ(four.nodes[1], (1 - 1 / std::sqrt(5.0)) / 2);
  EXPECT_DOUBLE_EQ(four.weights[0], 1 / 12.0);
  EXPECT_DOUBLE_EQ(four.weights[1], 5 / 12.0);
  EXPECT_DOUBLE_EQ(five.nodes[1], (1 - std::sqrt(3 / 7.0)) / 2);
  EXPECT_EQ(five.nodes[2], 0.5);
  EXPECT_DOUBLE_EQ(five.weights[0], 1 / 20.0);
  EXPECT_DOUBLE_EQ(five.weights[1], 49 / 180.0);
  EXPECT_DOUBLE_EQ(five.weights[2], 16 / 45.0);
}

TEST(Rule, RefusesWithTheNumbers) {
  try {
    gauss_rule(0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "points = 0; need 1 to 64");
  }
  EXPECT_THROW(lobatto_rule(1), std::invalid_argument);
  EXPECT_THROW(gauss_rule(max_points + 1), std::invalid_argument);
  EXPECT_THROW(lobatto_basis(0, {}), std::invalid_argument);
  EXPECT_THROW(legendre_matrix(max_degree + 1), std::invalid_argument);
}

/// Gauss points, the nodes themselves and points very close to nodes.
std::vector<double> awkward_points(int degree) {
  std::vector<double> points = gauss_rule(degree + 2).nodes;
  for (const double node : lobatto_rule(degree + 1).nodes) {
    points.push_back(node);
    points.push_back(std::nextafter(node, 0.5));
    points.push_back(std::abs(node - 1e-9));
  }
  return points;
}

TEST(Basis, DerivativeRowsSumToZeroAndValuesToOne) {
  for (int s = 1; s <= max_degree; ++s) {
    const Basis basis = lobatto_basis(s, awkward_points(s));
    for (std::size_t i = 0; i < basis.points.size(); ++i) {
      long double value = 0, derivative = 0;
      double largest = 0;
      for (int j = 0; j <= s; ++j) {
        value += basis.value[i * (s + 1) + j];
        derivative += basis.derivative[i * (s + 1) + j];
        largest = std::max(largest, std::abs(basis.derivative[i * (s + 1) + j]));
      }
      EXPECT_NEAR(static_cast<double>(value), 1, 2 * epsilon);
      EXPECT_LE(std::abs(static_cast<double>(derivative)), epsilon / 2 * largest) << "degree " << s;
    }
  }
}

TEST(Basis, NodesAreUnitVectors) {
  for (int s = 1; s <= max_degree; ++s) {
    const Basis basis = lobatto_basis(s, lobatto_rule(s + 1).nodes);
    for (int i = 0; i <= s; ++i)
      for (int j = 0; j <= s; ++j) EXPECT_EQ(basis.value[i * (s + 1) + j], i == j);
  }
}

TEST(Basis, PowersAndTheirDerivatives) {
  for (int s = 1; s <= max_degree; ++s) {
    const std::vector<double> nodes = lobatto_rule(s + 1).nodes;
    const Basis basis = lobatto_basis(s, awkward_points(s));
    for (int power = 0; power <= s; ++power)
      for (std::size_t i = 0; i < basis.points.size(); ++i) {
        double value = 0, derivative = 0, size = 0;
        for (int j = 0; j <= s; ++j) {
          const double f = std::pow(nodes[j], power);
          value += basis.value[i * (s + 1) + j] * f;
          derivative += basis.derivative[i * (s + 1) + j] * f;
          size += std::abs(basis.derivative[i * (s + 1) + j] * f);
        }
        const double x = basis.points[i];
        EXPECT_NEAR(value, std::pow(x, power), 1e-14) << "x^" << power << " at " << x;
        EXPECT_NEAR(derivative, power == 0 ? 0 : power * std::pow(x, power - 1), 1e-14 * std::max(1.0, size))
            << "x^" << power << " at " << x << ", degree " << s;
      }
  }
}

TEST(Basis, EndDerivativeIsTheClosedForm) {
  for (int s = 1; s <= max_degree; ++s) {
    const Basis basis = lobatto_basis(s, std::vector<double>{0, 1});
    EXPECT_DOUBLE_EQ(basis.derivative.front(), s == 1 ? -1 : -s * (s + 1) / 2.0);
    EXPECT_EQ(basis.derivative.back(), -basis.derivative.front());
  }
}

TEST(Basis, LegendreRoundTrip) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int s = 1; s <= max_degree; ++s) {
    const std::vector<double> nodes = lobatto_rule(s + 1).nodes, matrix = legendre_matrix(s);
    std::vector<double> coefficients(s + 1), values(s + 1, 0.0);
    for (double& c : coefficients) c = uniform(random);
    for (int j = 0; j <= s; ++j)
      for (int k = 0; k <= s; ++k) values[j] += coefficients[k] * std::legendre(k, 2 * nodes[j] - 1);
    for (int k = 0; k <= s; ++k) {
      double back = 0;
      for (int j = 0; j <= s; ++j) back += matrix[k * (s + 1) + j] * values[j];
      EXPECT_NEAR(back, coefficients[k], 3e-14) << "degree " << s << ", P_" << k;
    }
  }
}

TEST(Basis, BarycentricFormulaAgreesWithTheBasis) {
  for (int s = 1; s <= max_degree; ++s) {
    const Barycentric& element = lobatto_barycentric(s);
    const double x = 0.317;
    const std::vector<double> row = interpolation_matrix(s, std::vector<double>{x});
    double sum = 0;
    for (int j = 0; j <= s; ++j) sum += element.weights[j] / (x - element.nodes[j]);
    for (int j = 0; j <= s; ++j)
      EXPECT_NEAR(element.weights[j] / (x - element.nodes[j]) / sum, row[j], 1e-14);
  }
}

}  // namespace
}  // namespace extremal
