#include <complex>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/laws.hpp"
#include "solve/search/rest_energy.hpp"

/// \file Rests near equilibria that paths turn about, and minimisers between such. With z = x + iy, the drift
/// b = (−a + iω) z and L = |z' − b|²/2, extremals are e^iωt (A e^−at + B e^at); their energy |z'|²/2 − |b|²/2
/// is −2a² Re(A B*) + 2aω Im(A* B).

namespace extremal::laws {
namespace {

using namespace std::complex_literals;
using Complex = std::complex<double>;

constexpr double a = 1.5, omega = 4;

std::shared_ptr<const Lagrangian> turning_drift() {
  return trace(2, [](auto q, auto v, auto) {
    const auto x = v[0] + a * q[0] + omega * q[1];
    const auto y = v[1] + a * q[1] - omega * q[0];
    return (x * x + y * y) / 2.0;
  });
}

struct Turning {
  Complex in, out;  ///< A and B
  double energy() const {
    return -2 * a * a * (in * std::conj(out)).real() + 2 * a * omega * (std::conj(in) * out).imag();
  }
  State at(double t) const {
    const Complex turn = std::exp(1i * omega * t), falls = in * std::exp(-a * t),
                  rises = out * std::exp(a * t);
    const Complex z = turn * (falls + rises), v = turn * (1i * omega * (falls + rises) + a * (rises - falls));
    return {{z.real(), z.imag()}, {v.real(), v.imag()}};
  }
};

RestEnergy between(const State& before, const State& after, bool begins) {
  const auto drift = turning_drift();
  const NearEquilibrium equilibrium(*drift, Values{1e-3, 0});
  EXPECT_TRUE(equilibrium.hyperbolic());
  return equilibrium.energy({before.q, before.v, begins}, {after.q, after.v}, 1e-12, 0);
}

/// The tails stay as they are when a rest becomes longer; its energy changes like e^−al cos(ωl + phase).
TEST(RestEnergy, BetweenTailsThatTurn) {
  const Complex in = 1e-3 + 2e-4i, out = 7e-4 - 5e-4i;
  const auto turning = [&](double l) { return Turning{in, out * std::exp(-(a + 1i * omega) * l)}; };
  const RestEnergy rest = between(turning(2).at(0), turning(2).at(2), false);
  for (const double l : {1.0, 2.0, 2.2, 2.4, 2.6, 30.0}) {
    const double energy = turning(l).energy();
    EXPECT_NEAR(rest.at(l).log, std::log(std::abs(energy)), 1e-9) << l;
    EXPECT_EQ(rest.at(l).positive, energy > 0) << l;
    EXPECT_NEAR(rest.at(l).stiffness, (std::log(std::abs(turning(l - 1e-6).energy() / energy))) / 1e-6,
                1e-4 * std::abs(rest.at(l).stiffness) + 1e-5);
  }
  for (double l = 2; l < 2 + std::numbers::pi / omega; l += 0.05) {
    const std::optional<double> held = rest.held_near(l);
    ASSERT_TRUE(held.has_value()) << l;
    EXPECT_TRUE(rest.held_at(*held)) << l;
    EXPECT_LT(std::abs(*held - l), std::numbers::pi / omega + 0.1) << l;
  }
}

/// From the equilibrium, B = −A: the energy is |z'(0)|²/2.
TEST(RestEnergy, FromAnEnd) {
  const Complex out = 3e-6 + 1e-6i;
  const Turning turning{-out, out};
  const RestEnergy rest = between(turning.at(0), turning.at(3), true);
  EXPECT_NEAR(rest.at(3).log, std::log(2 * a * a * std::norm(out)), 1e-9);
  const double longer = rest.at(3).log - rest.at(40).log;
  EXPECT_NEAR(longer, 2 * a * 37, 2e-4);
  EXPECT_NEAR(rest.at(40).stiffness, 2 * a, 1e-9);
}

/// Of w(a) = w + c₁ a + c₂ a² three tails tell w, also where it passes zero between them; the doubt is what
/// c₂ makes of 2w(a) − w(2a).
TEST(RestEnergy, ExtrapolatedFromThreeTails) {
  const Complex w = 2e-3 - 1e-3i, linear = -0.3 + 0.2i, quadratic = 1.0 - 2.0i, rate = 1.5 + 4i;
  std::vector<RestEnergy> tails;
  std::array<double, 3> excess{};
  for (int k = 0; k < 3; ++k) {
    const double a = 0.04 / (1 << k);
    excess[k] = 0.7 * k;
    const Complex weight = (w + linear * a + quadratic * a * a) * std::exp(rate * excess[k]);
    tails.push_back(RestEnergy({{weight, rate}, {std::conj(weight), std::conj(rate)}}));
  }
  std::vector<RestEnergy::OfTail> measured;
  for (std::size_t k = 0; k < tails.size(); ++k) measured.push_back({&tails[k], excess[k]});
  const std::optional<RestEnergy> rest = RestEnergy::extrapolated(measured, 0);
  ASSERT_TRUE(rest.has_value());
  const RestEnergy::Action action = rest->action(2, 0);
  EXPECT_NEAR(action.energy, 2 * (w * std::exp(-2.0 * rate)).real(), 1e-16);
  EXPECT_NEAR(action.doubt, 2 * 2 * std::abs(quadratic) * 1e-4 * std::exp(-3.0), 1e-12);
  EXPECT_NEAR(action.value, 2 * (w * std::exp(-2.0 * rate) / rate).real(), 1e-16);
}

/// Six tails tell a polynomial of degree five. Of a function that is none, as the weight of a mode hidden
/// below a power of another, the doubt is more than the error. Noise is in the doubt as well.
TEST(RestEnergy, ExtrapolatedByAsManyPowersAsThereAre) {
  const auto extrapolated = [](const std::function<double(double)>& weight, double roundoff) {
    std::vector<RestEnergy> tails;
    for (int k = 0; k < 6; ++k) tails.push_back(RestEnergy({{weight(0.032 / (1 << k)), 1}}));
    std::vector<RestEnergy::OfTail> measured;
    for (const RestEnergy& tail : tails) measured.push_back({&tail, 0});
    return RestEnergy::extrapolated(measured, roundoff)->action(0, 0);
  };
  const auto polynomial = [](double a) { return 2 + a * (1 - a * (0.7 + a * (0.3 - a * (0.2 + a)))); };
  EXPECT_NEAR(extrapolated(polynomial, 0).energy, 2, 1e-13);
  EXPECT_LT(extrapolated(polynomial, 0).doubt, 1e-11);
  EXPECT_GT(extrapolated(polynomial, 1e-9).doubt, 2e-9);
  const RestEnergy::Action none = extrapolated([](double a) { return 2 + std::pow(a, 1.5); }, 0);
  EXPECT_GT(none.doubt, std::abs(none.energy - 2));
}

/// b = −∇U + c J ∇U across the saddle at 0 of U = (u² − 1)²/4 + v²/2. Actions by collocation of Hamilton's
/// equations (scipy's solve_bvp).
TEST(RestEnergy, MinimisersAcrossASaddleThatTheyTurnInto) {
  const auto drift = [](double c) {
    return trace(2, [c](auto q, auto v, auto) {
      const auto g = q[0] * q[0] * q[0] - q[0];
      const auto x = v[0] + g + c * q[1], y = v[1] + q[1] - c * g;
      return (x * x + y * y) / 2.0;
    });
  };
  struct Case {
    double c, T, action;
  };
  for (const auto& [c, T, action] :
       {Case{0.2, 30, 0.50000014286083}, Case{2, 16, 0.50000089467667}, Case{2, 20, 0.50000002493069}}) {
    const Solution s = solve(fixed_ends(drift(c), {-1, 0}, {1, 0}, T), within(1e-8));
    ASSERT_TRUE(s.converged()) << c << " " << T << ": " << s.message;
    EXPECT_NEAR(s.action, action, 1e-10) << c << " " << T;
    EXPECT_EQ(s.morse_index, 0);
  }
}

/// About the nodes the paths turn so fast that the energy of a rest there oscillates with its length.
TEST(RestEnergy, MinimisersBetweenRestsThatTheyTurnAbout) {
  const auto drift = trace(2, [](auto q, auto v, auto) {
    const auto g = q[0] * q[0] * q[0] - q[0];
    const auto x = v[0] + g + 4.0 * q[1], y = v[1] + q[1] - 4.0 * g;
    return (x * x + y * y) / 2.0;
  });
  for (const double T : {16.0, 30.0}) {
    const Solution s = solve(fixed_ends(drift, {-1, 0}, {1, 0}, T), within(1e-9));
    ASSERT_TRUE(s.converged()) << T << ": " << s.message;
    EXPECT_NEAR(s.action, T < 20 ? 0.500000034988 : 0.5, 1e-11) << T;
    EXPECT_EQ(s.morse_index, 0);
    EXPECT_LT(s.error_estimate, 2e-5) << T;
  }
}

/// (a + b t) e^−rt approaches the equilibrium where two rates coincide. Its energy is the sum of the same
/// with rates r ± δ, to second order in δ.
TEST(RestEnergy, OfPowersOfTheLength) {
  const double r = 1.3, delta = 1e-3, a = 0.7, b = -0.2;
  const RestEnergy one({{a, r, 0, 0}, {b, r, 0, 1}}),
      two({{0.5 * (a - b / delta), r + delta}, {0.5 * (a + b / delta), r - delta}});
  for (const double length : {2.0, 5.0}) {
    const RestEnergy::Action x = one.action(length, 3), y = two.action(length, 3);
    EXPECT_NEAR(x.energy, y.energy, 1e-4 * std::abs(y.energy));
    EXPECT_NEAR(x.value, y.value, 1e-4 * std::abs(y.value));
    EXPECT_NEAR(x.stiffness, y.stiffness, 1e-4 * std::abs(y.stiffness));
  }
  const std::vector<Complex> later = RestEnergy::OfTail{&one, 0.4}.weights();
  EXPECT_NEAR(later[0].real(), (a + 0.4 * b) * std::exp(-0.4 * r), 1e-15);
  EXPECT_NEAR(later[1].real(), b * std::exp(-0.4 * r), 1e-15);
}

/// At this saddle the drift has rates ±λ, so that Hamilton's equations have each of them twice, with one
/// eigenvector. Actions by minimisation of a finite-difference action, 0.18718.
TEST(RestEnergy, MinimisersIntoASaddleWhoseRatesCoincide) {
  const double c = 0.5, x = std::sqrt(1 - c * c);
  for (const double k : {1.0, 1.01}) {
    const auto drift = trace(2, [=](auto q, auto v, auto) {
      const auto u = v[0] - q[0] + q[0] * q[0] * q[0] + c * q[1], w = v[1] + k * q[1] - k * c * q[0];
      return (u * u + w * w) / 2.0;
    });
    for (const double T : {30.0, 50.0, 100.0}) {
      const Solution s = solve(fixed_ends(drift, {x, c * x}, {0, 0}, T), within(1e-9));
      ASSERT_TRUE(s.converged()) << k << " " << T << ": " << s.message;
      EXPECT_NEAR(s.action, k == 1 ? 0.1871769763 : 0.1880234295, 1e-9) << k << " " << T;
      EXPECT_EQ(s.morse_index, 0) << k << " " << T;
    }
  }
}

/// Lorenz's drift from a node that paths turn about, by phases on which their tails depend, into the saddle
/// at 0. At T = 20 and 25 energies hold them beyond the digits of doubles, and 106 bits find where.
TEST(RestEnergy, PathsThatMoreDigitsHold) {
  const auto drift = trace(3, [](auto q, auto v, auto) {
    const auto x = v[0] - 10.0 * (q[1] - q[0]), y = v[1] - q[0] * (10.0 - q[2]) + q[1],
               z = v[2] - q[0] * q[1] + 8.0 / 3.0 * q[2];
    return (x * x + y * y + z * z) / 2.0;
  });
  const double c = std::sqrt(24.0);
  for (const double T : {20.0, 25.0}) {
    const auto along = [&](const Solution& s) {
      std::vector<double> values(3), v(3), all;
      for (int k = 0; k <= 400; ++k) {
        s.trajectory.at(T * k / 400, values, v);
        all.insert(all.end(), values.begin(), values.end());
      }
      return all;
    };
    const auto path = [&](double tolerance) {
      return solve(fixed_ends(drift, {c, c, 9}, {0, 0, 0}, T), within(tolerance));
    };
    const Solution best = path(1e-11);
    ASSERT_TRUE(best.converged()) << T << ": " << best.message;
    EXPECT_LT(best.error_estimate, 1e-9) << T;
    const std::vector<double> exact = along(best);
    for (const double tolerance : {1e-6, 1e-8}) {
      const Solution s = path(tolerance);
      ASSERT_TRUE(s.converged()) << T << ": " << s.message;
      const std::vector<double> values = along(s);
      double error = 0;
      for (std::size_t k = 0; k < values.size(); ++k) error = std::max(error, std::abs(values[k] - exact[k]));
      EXPECT_LT(error, 3 * s.error_estimate + 1e-9) << T << " " << tolerance;
    }
  }
}

/// The drift of FitzHugh and Nagumo between two nodes, whose slow rate is r = (4.5 − √4.25)/2, across a
/// saddle that is left at the fast rate ν = (1.5 + √10.25)/2. All rests become longer by a duration as 1/2r
/// and 1/ν: so the passage to the saddle is later by 1/2r of 1/r + 1/ν. At T = 36
/// either way finds it.
TEST(RestEnergy, SlowMotionsOfNoEnergyHoldNothing) {
  LONG_TEST();
  const auto drift = trace(2, [](auto q, auto v, auto) {
    const auto x = v[0] - 2.0 * (q[0] - q[0] * q[0] * q[0]) - (0.5 * q[0] - q[1]),
               y = v[1] - 0.5 * (q[0] - 2.0 * q[1]);
    return (x * x + y * y) / 2.0;
  });
  const double r = (4.5 - std::sqrt(4.25)) / 2, nu = (1.5 + std::sqrt(10.25)) / 2;
  const auto passage = [&](double T) {
    const Solution s = solve(fixed_ends(drift, {-1, -0.5}, {1, 0.5}, T), within(1e-9));
    EXPECT_TRUE(s.converged()) << T << ": " << s.message;
    EXPECT_NEAR(s.action, 0.481466957407, 1e-11) << T;
    if (T >= 40) {
      EXPECT_EQ(s.nullity, 2) << T;
    }
    double before = 0, after = T / 2;
    for (int k = 0; k < 60 && s.converged(); ++k) {
      const double t = 0.5 * (before + after);
      (at(s.trajectory, t).q[0] < -0.5 ? before : after) = t;
    }
    return before;
  };
  const double share = 1 / (2 * r) / (1 / r + 1 / nu), at40 = passage(40);
  EXPECT_NEAR(at40 - passage(36), 4 * share, 3e-5);
  EXPECT_NEAR(passage(60) - at40, 20 * share, 1e-5);
}

}  // namespace
}  // namespace extremal::laws
