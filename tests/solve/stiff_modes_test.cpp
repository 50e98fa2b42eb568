#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file Modes of very different frequencies beside their closed forms.

namespace extremal::laws {
namespace {

/// V = (x² + k y² + x y)/2 by normal modes, each u(t) = (u(0) sin ω(T − t) + u(T) sin ωt)/sin ωT.
TEST(StiffModes, AreThoseOfTheClosedForm) {
  LONG_TEST();
  const double k = 5e7, T = 10;
  const auto lagrangian = trace(2, [k](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - k * q[1] * q[1] - q[0] * q[1]) / 2.0;
  });
  const Values start{1, 0.1}, end{0.5, -0.05};
  // The axis (c, s) of the larger eigenvalue of ((1, 1/2), (1/2, k)).
  const double angle = 0.5 * std::atan2(1.0, 1 - k), c = std::cos(angle), s = std::sin(angle);
  const double larger = (1 + k) / 2 + std::hypot((k - 1) / 2, 0.5);
  const double fast = std::sqrt(larger), slow = std::sqrt((k - 0.25) / larger);
  const auto mode = [&](double omega, double from, double to, double t) {
    return (from * std::sin(omega * (T - t)) + to * std::sin(omega * t)) / std::sin(omega * T);
  };
  const auto truth = [&](double t) {
    const double a = mode(fast, c * start[0] + s * start[1], c * end[0] + s * end[1], t);
    const double b = mode(slow, c * start[1] - s * start[0], c * end[1] - s * end[0], t);
    return Values{c * a - s * b, s * a + c * b};
  };
  const Solution found = solve(fixed_ends(lagrangian, start, end, T), within(1e-9));
  EXPECT_LT(distance(found.trajectory, truth), 1e-8);
  EXPECT_LE(found.error_estimate, 2e-9);
  // Morse: ⌊ωT/π⌋ of each mode.
  EXPECT_EQ(found.morse_index, static_cast<int>(slow * T / M_PI) + static_cast<int>(fast * T / M_PI));
}

/// Elements that resolve the slow mode, to which the ends belong, cannot count conjugate times of the fast
/// one.
TEST(StiffModes, ThatAreNotResolvedHaveNoIndex) {
  const double k = 1e10, T = 10;
  const auto lagrangian = trace(2, [k](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - k * q[1] * q[1]) / 2.0;
  });
  const Solution found = solve(fixed_ends(lagrangian, {1, 0}, {0.5, 0}, T), within(1e-9));
  EXPECT_FALSE(found.morse_index);
  EXPECT_FALSE(found.nullity);
  EXPECT_NE(found.message.find("do not tell its index"), std::string::npos) << found.message;
}

}  // namespace
}  // namespace extremal::laws
