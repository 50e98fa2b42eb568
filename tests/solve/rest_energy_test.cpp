#include <complex>
#include <numbers>

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
  const NearEquilibrium equilibrium(*turning_drift(), Values{1e-3, 0});
  EXPECT_TRUE(equilibrium.hyperbolic());
  return equilibrium.energy({before.q, before.v, begins}, {after.q, after.v}, 1e-12);
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
    const std::optional<double> held = rest.held_near(l, true);
    ASSERT_TRUE(held.has_value()) << l;
    EXPECT_TRUE(rest.held_at(*held, true)) << l;
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

}  // namespace
}  // namespace extremal::laws
