#include "rivals/shooting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "rivals/flow.hpp"
#include "rivals/problems.hpp"

namespace extremal {
namespace {

using std::numbers::pi;

TEST(Fly, KeplerOrbitCloses) {
  // a = 1, e = 0.6, from pericentre.
  const double e = 0.6;
  const std::vector<double> q = {1 - e, 0}, v = {0, std::sqrt((1 + e) / (1 - e))}, times = {pi, 2 * pi};
  const Flight flight = fly(*kepler(), q, v, times);
  ASSERT_TRUE(flight.complete);
  EXPECT_NEAR(flight.q[0], -1 - e, 1e-11);
  EXPECT_NEAR(flight.v[1], -std::sqrt((1 - e) / (1 + e)), 1e-11);
  EXPECT_NEAR(flight.q[2], q[0], 1e-11);
  EXPECT_NEAR(flight.q[3], 0, 1e-11);
  EXPECT_NEAR(flight.v[3], v[1], 1e-11);
}

TEST(Fly, MomentumThatDependsOnTime) {
  // L = e^{t/5} (v² − q²)/2: q'' + q'/5 + q = 0.
  const auto damped =
      trace(1, [](auto q, auto v, auto t) { return exp(t / 5.0) * (v[0] * v[0] - q[0] * q[0]) / 2.0; });
  const double rate = 0.1, omega = std::sqrt(1 - rate * rate), time = 7;
  const Flight flight = fly(*damped, std::vector{1.0}, std::vector{-rate}, std::vector{time});
  ASSERT_TRUE(flight.complete);
  EXPECT_NEAR(flight.q[0], std::exp(-rate * time) * std::cos(omega * time), 1e-12);
}

TEST(Fly, MomentumThatIsNotLinearInVelocity) {
  // Relativistic: p = v/√(1 − v²) = t/2 from rest, q = 2 (√(1 + t²/4) − 1).
  const auto rocket = trace(1, [](auto q, auto v, auto) { return q[0] / 2.0 - sqrt(1.0 - v[0] * v[0]); });
  const Flight flight = fly(*rocket, std::vector{0.0}, std::vector{0.0}, std::vector{1.0, 20.0});
  ASSERT_TRUE(flight.complete);
  EXPECT_NEAR(flight.q[0], 2 * (std::sqrt(1.25) - 1), 1e-13);
  EXPECT_NEAR(flight.q[1], 2 * (std::sqrt(101) - 1), 1e-11);
  EXPECT_NEAR(flight.v[1], 10 / std::sqrt(101), 1e-13);
}

TEST(Fly, ChargeTurnsInItsField) {
  const auto charge = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 + (q[0] * v[1] - q[1] * v[0]);
  });
  const Flight flight = fly(*charge, std::vector{1.0, 0.0}, std::vector{0.0, -2.0}, std::vector{0.0, 1.25});
  ASSERT_TRUE(flight.complete);
  EXPECT_EQ(flight.q[0], 1);
  EXPECT_NEAR(flight.q[2], std::cos(2.5), 1e-12);
  EXPECT_NEAR(flight.q[3], -std::sin(2.5), 1e-12);
}

TEST(Fly, ChainInItsNormalMode) {
  // 100 unit masses between walls: q_i = sin(πi/101) cos(ωt), ω = 2 sin(π/202).
  constexpr int n = 100;
  const auto chain = trace(n, [](auto q, auto v, auto) {
    auto sum = v[0] * v[0] - q[0] * q[0] - q[n - 1] * q[n - 1];
    for (int i = 1; i < n; ++i) sum = sum + v[i] * v[i] - (q[i] - q[i - 1]) * (q[i] - q[i - 1]);
    return sum / 2.0;
  });
  std::vector<double> q(n), v(n, 0.0);
  for (int i = 0; i < n; ++i) q[i] = std::sin(pi * (i + 1) / (n + 1));
  const double omega = 2 * std::sin(pi / (2 * (n + 1)));
  const Flight flight = fly(*chain, q, v, std::vector{50.0}, 1e-14);
  ASSERT_TRUE(flight.complete);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(flight.q[i], q[i] * std::cos(50 * omega), 1e-12);
}

TEST(Fly, StopsAtACollision) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  // Free fall from 1 reaches the centre after π/(2√2).
  const Flight flight = fly(*central, std::vector{1.0}, std::vector{0.0}, std::vector{0.5, 2.0});
  EXPECT_FALSE(flight.complete);
  EXPECT_EQ(flight.q.size(), 1u);
  EXPECT_NEAR(flight.reached, pi / (2 * std::sqrt(2.0)), 1e-6);
}

TEST(Fly, MalformedIsRefused) {
  const auto system = pendulum();
  EXPECT_THROW(fly(*system, std::vector{1.0, 2.0}, std::vector{0.0}, std::vector{1.0}),
               std::invalid_argument);
  EXPECT_THROW(fly(*system, std::vector{1.0}, std::vector{0.0}, std::vector{1.0, 0.5}),
               std::invalid_argument);
  EXPECT_THROW(fly(*system, std::vector{1.0}, std::vector{0.0}, std::vector{-1.0}), std::invalid_argument);
}

TEST(Flow, VariationsAreTheDerivativeOfTheSlope) {
  const auto system = double_pendulum();
  Flow flow(*system);
  constexpr int n = 2;
  const std::vector<double> q = {0.4, -1.1}, v = {0.7, 2.3};
  std::vector<double> y(2 * n * 5, 0.0), slope(y.size());
  std::copy(q.begin(), q.end(), y.begin());
  ASSERT_TRUE(flow.momentum(q, v, 0, std::span(y).subspan(n, n)));
  for (int c = 0; c < 2 * n; ++c) y[2 * n * (c + 1) + c] = 1;
  ASSERT_TRUE(flow.slope_with_variations(0, y, slope));
  EXPECT_NEAR(slope[0], v[0], 1e-14);
  EXPECT_NEAR(slope[1], v[1], 1e-14);
  for (int c = 0; c < 2 * n; ++c) {
    const auto at = [&](double h) {
      std::vector<double> z(y.begin(), y.begin() + 2 * n), f(2 * n);
      z[c] += h;
      EXPECT_TRUE(flow.slope(0, z, f));
      return f;
    };
    const double h = 1e-3;
    const auto a = at(-2 * h), b = at(-h), d = at(h), e = at(2 * h);
    for (int i = 0; i < 2 * n; ++i)
      EXPECT_NEAR(slope[2 * n * (c + 1) + i], (a[i] - 8 * b[i] + 8 * d[i] - e[i]) / (12 * h), 2e-9) << c << i;
  }
}

void expect_reference(const Problem& problem, const std::string& name, double bound) {
  const Shot shot = shoot(problem, {.tolerance = 1e-12});
  ASSERT_EQ(shot.status, Status::converged) << name << ": " << shot.message;
  const auto rows = reference(name);
  ASSERT_EQ(rows.size(), 201u);
  const std::size_t n = problem.coordinates();
  std::vector<double> times;
  for (const auto& row : rows) times.push_back(row[0]);
  const std::span<const double> start(problem.ends.offset.data(), n);
  const Flight flight = fly(*problem.lagrangian, start, shot.velocity_start, times);
  ASSERT_TRUE(flight.complete);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t a = 0; a < n; ++a) {
      EXPECT_NEAR(flight.q[k * n + a], rows[k][1 + a], bound) << name << " at t = " << times[k];
      EXPECT_NEAR(flight.v[k * n + a], rows[k][1 + n + a], 10 * bound) << name << " at t = " << times[k];
    }
}

TEST(Shoot, ReferenceSolutions) {
  expect_reference(fixed_ends(kepler(), {1, 0}, {-0.6, 0.9}, 2.5), "kepler-arc", 1e-11);
  expect_reference(fixed_ends(pendulum(), {0}, {1.5}, 2), "pendulum-short", 1e-11);
  expect_reference(fixed_ends(double_pendulum(), {0, 0}, {1, 2}, 1), "double-pendulum-1", 1e-11);
}

TEST(Shoot, StartsFromTheVelocityOfTheGuess) {
  // To the same end in the same time: back and forth once, or slowly past the top.
  Problem swinging = fixed_ends(pendulum(), {0}, {1}, 6), past = swinging;
  swinging.guess = {{0, 0.2, 1}, {0, -1.1, 1}};
  past.guess = {{0, 0.1, 1}, {0, 1.05, 1}};
  const Shot a = shoot(swinging), b = shoot(past);
  ASSERT_TRUE(a.status == Status::converged && b.status == Status::converged) << a.message << b.message;
  EXPECT_LT(a.velocity_start[0], -1);
  EXPECT_GT(b.velocity_start[0], 1.8);
}

TEST(Shoot, RefusesWhatItCannotPose) {
  Problem problem = fixed_ends(pendulum(), {0}, {1}, 1);
  problem.boundary = {};
  problem.boundary.coordinates = 1;
  EXPECT_THROW(shoot(make_problem(problem)), std::invalid_argument);
}

TEST(Shoot, SaysThatItFailed) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  const Shot shot = shoot(fixed_ends(central, {1}, {-1}, 1));
  EXPECT_NE(shot.status, Status::converged);
  EXPECT_FALSE(shot.message.empty());
}

}  // namespace
}  // namespace extremal
