#include "analysis/multipliers.hpp"

#include <complex>
#include <numbers>

#include "analysis/independent.hpp"

/// \file Floquet multipliers in closed form, and against the linearised flow integrated forward.

namespace extremal::laws {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// At rest at q = 0 over [0, T].
Trajectory at_rest(int coordinates, double T, int elements) {
  Trajectory rest{.coordinates = coordinates, .degree = 4, .times = {}, .nodes = {}};
  for (int k = 0; k <= elements; ++k) rest.times.push_back(T * k / elements);
  rest.nodes.assign(static_cast<std::size_t>(elements) * 5 * coordinates, 0.0);
  return rest;
}

std::optional<Floquet> floquet_at_rest(const std::shared_ptr<const Lagrangian>& lagrangian, double T,
                                       const Eigen::MatrixXd& map = {}) {
  const Trajectory rest = at_rest(lagrangian->structure().coordinates, T, 4);
  SecondVariation variation;
  if (!variation.assemble(lagrangian, rest)) throw std::runtime_error("no pieces");
  return floquet(variation,
                 {.map = map, .relative_error = 0, .autonomous = lagrangian->structure().autonomous});
}

/// In any order, each relative to its own size; the defect is what the list says.
void expect_multipliers(const Floquet& floquet, std::vector<Complex> truth, double allowed) {
  ASSERT_EQ(floquet.multipliers.size(), truth.size());
  ASSERT_EQ(floquet.krein.size(), truth.size());
  EXPECT_LT(floquet.symplectic_defect, 1e-14);
  for (const Complex& value : floquet.multipliers) {
    const auto nearest = std::min_element(truth.begin(), truth.end(), [&](Complex a, Complex b) {
      return std::abs(a / value - 1.0) < std::abs(b / value - 1.0);
    });
    EXPECT_LT(std::abs(value / *nearest - 1.0), allowed) << value << " beside " << *nearest;
    truth.erase(nearest);
  }
}

std::vector<Complex> with_inverses(std::vector<Complex> values) {
  for (std::size_t k = 0, count = values.size(); k < count; ++k) values.push_back(1.0 / values[k]);
  return values;
}

/// Σ (u'² − c u²)/2 with u = S q: normal modes of squared frequency c, mixed.
std::shared_ptr<const Lagrangian> modes(const Values& c) {
  return trace(static_cast<int>(c.size()), [&](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (std::size_t i = 0; i < c.size(); ++i) {
      auto x = q[i], y = v[i];
      for (std::size_t j = 0; j < c.size(); ++j) {
        x = x + 0.3 * std::cos(1.0 + 3 * i + j) * q[j];
        y = y + 0.3 * std::cos(1.0 + 3 * i + j) * v[j];
      }
      l = l + (y * y - c[i] * x * x) / 2;
    }
    return l;
  });
}

/// e^{±iωT}, with the sign −1 above the axis.
TEST(Multipliers, OfOscillators) {
  for (const Values& omega : {Values{0.31}, Values{1.0, 0.4}, Values{0.7, 1.3, 2.1}, Values{1.1, 1.1, 0.3}})
    for (double T : {0.5, 3.3, 24.4, 100.0}) {
      Values c;
      std::vector<Complex> truth;
      for (double w : omega) {
        c.push_back(w * w);
        truth.push_back(std::polar(1.0, w * T));
      }
      const Floquet found = floquet_at_rest(modes(c), T).value();
      expect_multipliers(found, with_inverses(truth), 1e-11);
      EXPECT_TRUE(found.stable());
      EXPECT_EQ(found.circle_pairs, omega.size());
      for (std::size_t k = 0; k < truth.size(); ++k) {
        EXPECT_NEAR(std::abs(found.multipliers[2 * k]), 1, 1e-15);
        EXPECT_GT(found.multipliers[2 * k].imag(), 0);
        EXPECT_EQ(found.multipliers[2 * k + 1], std::conj(found.multipliers[2 * k]));
        // Above the axis: e^{iωT} or e^{−iωT}.
        const auto on = [&](double w) {
          return std::abs(std::polar(1.0, w * T) - found.multipliers[2 * k]) < 1e-9;
        };
        const int sign = std::any_of(omega.begin(), omega.end(), on) ? -1 : 1;
        EXPECT_EQ(found.krein[2 * k], sign);
        EXPECT_EQ(found.krein[2 * k + 1], -sign);
      }
    }
}

/// Seen from a frame that turns with Ω the modes e^{i(ω−Ω)t} and e^{i(ω+Ω)t} keep their sign −1, also for
/// Ω > ω, where the first turns backwards.
TEST(Multipliers, KreinSignsInATurningFrame) {
  const double w = 1, turn = 1.7;
  const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
    const auto x = v[0] - turn * q[1], y = v[1] + turn * q[0];
    return (x * x + y * y - w * w * (q[0] * q[0] + q[1] * q[1])) / 2;
  });
  const auto found_after = [&](double T) {
    const Floquet found = floquet_at_rest(lagrangian, T).value();
    const Complex slow = std::polar(1.0, (w - turn) * T), fast = std::polar(1.0, (w + turn) * T);
    expect_multipliers(found, with_inverses({slow, fast}), 1e-12);
    return found;
  };
  for (double T : {0.5, 1.0, 2.9}) {
    const Floquet found = found_after(T);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto is = [&](double rate) {
        return std::abs(found.multipliers[k] - std::polar(1.0, rate * T)) < 1e-9;
      };
      EXPECT_EQ(found.krein[k], is(w - turn) || is(w + turn) ? -1 : 1) << T;
    }
  }
  // Equal multipliers, of one sign or of both.
  const auto balance = [](const Floquet& found) {
    int sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += found.multipliers[k].imag() > 0 ? found.krein[k] : 0;
    return std::abs(sum);
  };
  EXPECT_EQ(balance(found_after(pi / turn)), 2);
  EXPECT_EQ(balance(found_after(pi / w)), 0);
}

/// Eigenvalues 1e±12, 1e±6 and on the unit circle of one matrix, modes mixed and the frame turning once in T.
TEST(Multipliers, OfTwelveOrdersOfMagnitude) {
  const double T = 2 * pi, a = std::log(1e12) / T, b = std::log(1e6) / T, w = 0.37;
  const auto lagrangian = trace(3, [=](auto q, auto v, auto t) {
    const auto x = cos(t) * q[0] - sin(t) * q[1], y = sin(t) * q[0] + cos(t) * q[1];
    const auto dx = cos(t) * v[0] - sin(t) * v[1] - y, dy = sin(t) * v[0] + cos(t) * v[1] + x;
    const auto f = x + 0.4 * q[2], g = y - 0.7 * q[2] + 0.2 * x, h = q[2] - 0.5 * x;
    const auto df = dx + 0.4 * v[2], dg = dy - 0.7 * v[2] + 0.2 * dx, dh = v[2] - 0.5 * dx;
    return (df * df + dg * dg + dh * dh + a * a * f * f + b * b * g * g - w * w * h * h) / 2;
  });
  const Floquet found = floquet_at_rest(lagrangian, T).value();
  expect_multipliers(found, with_inverses({1e12, 1e6, std::polar(1.0, w * T)}), 1e-11);
  EXPECT_EQ(found.real_pairs, 2);
  EXPECT_EQ(found.circle_pairs, 1);
  EXPECT_FALSE(found.stable());
  EXPECT_EQ(found.krein, (std::vector<int>{0, 0, found.krein[2], -found.krein[2], 0, 0}));
  EXPECT_NEAR(found.multipliers[0].real() / 1e12, 1, 1e-11);
  EXPECT_NEAR(found.multipliers[5].real() * 1e12, 1, 1e-11);
}

/// An unstable focus: e^{(±σ ± iΩ)T}, four together, up to 1e12.
TEST(Multipliers, OfAnUnstableFocus) {
  const double T = 5, turn = 0.83;
  for (double largest : {1.5, 30.0, 1e5, 1e12}) {
    const double sigma = std::log(largest) / T;
    const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
      const auto x = v[0] - turn * q[1], y = v[1] + turn * q[0];
      return (x * x + y * y + sigma * sigma * (q[0] * q[0] + q[1] * q[1])) / 2;
    });
    const Floquet found = floquet_at_rest(lagrangian, T).value();
    const Complex lambda = std::polar(largest, turn * T);
    expect_multipliers(found, with_inverses({lambda, std::conj(lambda)}), 1e-11);
    EXPECT_EQ(found.quadruples, 1);
    EXPECT_EQ(found.real_pairs, 0);
    EXPECT_GT(found.multipliers[0].imag(), 0);
    EXPECT_EQ(found.multipliers[1], std::conj(found.multipliers[0]));
    EXPECT_EQ(found.krein, (std::vector<int>{0, 0, 0, 0}));
  }
}

/// Equal moduli by argument: 3, −3 as e^{σT} of two modes of which one is reversed at the end.
TEST(Multipliers, InTheirOrder) {
  const double T = 2, c = -std::pow(std::log(3.0) / T, 2);
  const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - c * (q[0] * q[0] + q[1] * q[1])) / 2;
  });
  const Eigen::MatrixXd map = Eigen::Vector2d(-1, 1).asDiagonal();
  const Floquet found = floquet_at_rest(lagrangian, T, map).value();
  const Values truth{3, -3, 1.0 / 3, -1.0 / 3};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT(std::abs(found.multipliers[k] - truth[k]), 1e-13);
}

/// Closed by exchanging two equal oscillators, in other units: of their sum e^{±iωT}, of their difference
/// −e^{±iωT}.
TEST(Multipliers, OfTheFlowUpToASymmetry) {
  const double w = 0.9, T = 1.3, scale = 1e4;
  const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
    const auto y = scale * q[1], dy = scale * v[1];
    return (v[0] * v[0] + dy * dy - w * w * (q[0] * q[0] + y * y)) / 2;
  });
  Eigen::MatrixXd exchange(2, 2);
  exchange << 0, scale, 1 / scale, 0;
  const Complex lambda = std::polar(1.0, w * T);
  const Floquet found = floquet_at_rest(lagrangian, T, exchange).value();
  expect_multipliers(found, with_inverses({lambda, -lambda}), 1e-12);
  EXPECT_EQ(found.circle_pairs, 2);
}

/// Characteristic values of x'' + (a − 2 cos 2t) x = 0 (Abramowitz and Stegun, table 20.1, q = 1), where a
/// solution has the period π or 2π; stable between them by turns.
TEST(Multipliers, OfMathieusEquation) {
  const auto over_pi = [](double a) {
    const auto lagrangian = trace(
        1, [=](auto q, auto v, auto t) { return (v[0] * v[0] - (a - 2 * cos(2 * t)) * q[0] * q[0]) / 2; });
    return floquet_at_rest(lagrangian, pi).value();
  };
  struct Characteristic {
    double value;
    int multiplier;
  };
  const Characteristic table[] = {
      {-0.45513860, 1}, {-0.11024882, -1}, {1.85910807, -1}, {3.91702477, 1}, {4.37130098, 1}};
  for (const auto& [a, multiplier] : table) {
    const Floquet found = over_pi(a);
    EXPECT_NEAR((found.multipliers[0] + found.multipliers[1]).real(), 2 * multiplier, 1e-7) << a;
    EXPECT_NE(over_pi(a - 1e-5).stable(), over_pi(a + 1e-5).stable()) << a;
  }
  EXPECT_FALSE(over_pi(-0.5).stable());
  EXPECT_TRUE(over_pi(-0.3).stable());
  EXPECT_LT(over_pi(1).multipliers[0].real(), -1);
}

TEST(Multipliers, ThatOverflowAreLeftOut) {
  const auto lagrangian = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] + q[0] * q[0]) / 2; });
  EXPECT_NEAR(floquet_at_rest(lagrangian, 600).value().multipliers[0].real() / std::exp(600), 1, 1e-11);
  EXPECT_FALSE(floquet_at_rest(lagrangian, 800).has_value());
}

}  // namespace
}  // namespace extremal::laws
