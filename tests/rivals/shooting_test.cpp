#include "rivals/shooting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "motion/flow.hpp"
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

TEST(Fly, FromAllButRest) {
  // p is roundoff where the motion turns: its size tells nothing of the step.
  const Flight flight = fly(*oscillator(), std::vector{1.0}, std::vector{1e-17}, std::vector{1.0});
  ASSERT_TRUE(flight.complete);
  EXPECT_NEAR(flight.q[0], std::cos(1), 1e-12);
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

/// Both kinds of shooting, against the rows of a reference solution.
void expect_reference(Problem problem, const std::string& name, double bound, int segments) {
  const auto rows = reference(name);
  const std::size_t n = problem.coordinates();
  const Shot shot = shoot(problem, {.tolerance = 1e-12, .segments = segments});
  ASSERT_EQ(shot.status, Status::converged) << name << ": " << shot.message;
  ASSERT_EQ(shot.q.size(), n * segments);
  std::vector<double> times;
  for (const auto& row : rows) times.push_back(row[0]);
  const Flight flight = follow(*problem.lagrangian, shot, times, 1e-14);
  ASSERT_TRUE(flight.complete);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t a = 0; a < n; ++a) {
      EXPECT_NEAR(flight.q[k * n + a], rows[k][1 + a], bound) << name << " at t = " << times[k];
      EXPECT_NEAR(flight.v[k * n + a], rows[k][1 + n + a], 10 * bound) << name << " at t = " << times[k];
    }
}

TEST(Shoot, ReferenceSolutions) {
  for (const int segments : {1, 8, 20})
    expect_reference(fixed_ends(kepler(), {1, 0}, {-0.6, 0.9}, 2.5), "kepler-arc", 1e-11, segments);
  for (const int segments : {1, 3, 8, 20}) {
    expect_reference(fixed_ends(pendulum(), {0}, {1.5}, 2), "pendulum-short", 1e-11, segments);
    expect_reference(fixed_ends(double_pendulum(), {0, 0}, {1, 2}, 1), "double-pendulum-1", 1e-11, segments);
  }
}

/// Samples of a CSV of bench/data as a guess: t, then the coordinates, whatever follows.
Guess guess_of(const std::string& name, int n) {
  Guess guess;
  const auto rows = reference(name);
  for (const auto& row : rows) {
    guess.tau.push_back(row[0] / rows.back()[0]);
    guess.q.insert(guess.q.end(), row.begin() + 1, row.begin() + 1 + n);
  }
  guess.tau.back() = 1;
  return guess;
}

TEST(Shoot, ChaoticMotionInSegments) {
  const auto rows = reference("henon-heiles-60");
  Problem problem =
      fixed_ends(henon_heiles(), {rows.front()[1], rows.front()[2]}, {rows.back()[1], rows.back()[2]}, 60);
  problem.guess = guess_of("henon-heiles-60-guess", 2);
  expect_reference(problem, "henon-heiles-60", 1e-9, 16);
}

TEST(Shoot, StartsFromTheVelocityOfTheGuess) {
  // To the same end in the same time: back and forth once, or slowly past the top.
  Problem swinging = fixed_ends(pendulum(), {0}, {1}, 6), past = swinging;
  swinging.guess = {{0, 0.2, 1}, {0, -1.1, 1}};
  past.guess = {{0, 0.1, 1}, {0, 1.05, 1}};
  const Shot a = shoot(swinging), b = shoot(past);
  ASSERT_TRUE(a.converged() && b.converged()) << a.message << b.message;
  EXPECT_LT(a.v[0], -1);
  EXPECT_GT(b.v[0], 1.8);
}

TEST(Shoot, NaturalEnds) {
  // q'' = −q from 1 to where q' = 0: cos t + tan(T) sin t.
  Problem problem;
  problem.lagrangian = oscillator();
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 1);
  problem.duration.value = 3;
  problem = make_problem(problem);
  for (const int segments : {1, 4}) {
    const Shot shot = shoot(problem, {.tolerance = 1e-12, .segments = segments});
    ASSERT_TRUE(shot.converged()) << shot.message;
    EXPECT_NEAR(shot.v[0], std::tan(3.0), 1e-11);
  }
}

TEST(Shoot, FreeDurationClosedByWhere) {
  // From the lowest point at rest on top of the swing: a quarter of the period 4 K(sin(1/2)) for q = 1.
  Problem problem;
  problem.lagrangian = pendulum();
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 0);
  problem.duration = {.value = 1.5, .free = true, .energy = {}, .where = [](auto, auto end, auto gradient) {
                        gradient[0] = 0;
                        gradient[1] = 1;
                        return end[0] - 1;
                      }};
  problem.guess = {{0, 1}, {0, 0.8}};
  problem = make_problem(problem);
  for (const int segments : {1, 8}) {
    const Shot shot = shoot(problem, {.tolerance = 1e-12, .segments = segments});
    ASSERT_TRUE(shot.converged()) << shot.message;
    EXPECT_NEAR(shot.duration(), std::comp_ellint_1(std::sin(0.5)), 1e-11);
    EXPECT_NEAR(shot.v[0], 2 * std::sin(0.5), 1e-11);
  }
}

TEST(Shoot, PeriodicOrbitOfGivenEnergy) {
  // The pendulum that swings to 1: E = −cos 1, period 4 K(sin(1/2)).
  Problem problem;
  problem.lagrangian = pendulum();
  problem.boundary.coordinates = 1;
  const int row = problem.boundary.add_row(0);
  problem.boundary.add(row, 0, 1);
  problem.boundary.add(row, 1, -1);
  problem.periodic = true;
  problem.duration = {.value = 6.4, .free = true, .energy = -std::cos(1), .where = {}};
  for (int k = 0; k <= 64; ++k) {
    problem.guess.tau.push_back(k / 64.0);
    problem.guess.q.push_back(1.1 * std::cos(2 * pi * k / 64 + 0.4));
  }
  problem = make_problem(problem);
  for (const int segments : {1, 8}) {
    const Shot shot = shoot(problem, {.tolerance = 1e-11, .segments = segments});
    ASSERT_TRUE(shot.converged()) << shot.message;
    EXPECT_NEAR(shot.duration(), 4 * std::comp_ellint_1(std::sin(0.5)), 1e-9);
    const Flight flight = follow(*problem.lagrangian, shot, std::vector{0.0, shot.duration()});
    EXPECT_NEAR(flight.q[0], flight.q[1], 1e-9);
    EXPECT_NEAR(flight.v[0], flight.v[1], 1e-9);
  }
}

TEST(Shoot, LargeTolerancesAreMetToo) {
  const Problem problem = fixed_ends(pendulum(), {0}, {1.5}, 2);
  const Shot rough = shoot(problem, {.tolerance = 1e-3}), fine = shoot(problem, {.tolerance = 1e-13});
  ASSERT_TRUE(rough.converged() && fine.converged());
  EXPECT_NEAR(rough.v[0], fine.v[0], 1e-3);
  EXPECT_LT(rough.steps, fine.steps);
}

TEST(Shoot, RefusesWhatItCannotPose) {
  EXPECT_THROW(shoot(fixed_ends(pendulum(), {0}, {1}, 1), {.segments = 0}), std::invalid_argument);
  const auto singular = trace(2, [](auto q, auto v, auto) {
    return (v[0] + v[1]) * (v[0] + v[1]) / 2.0 - q[0] * q[0] - q[1] * q[1];
  });
  EXPECT_THROW(shoot(fixed_ends(singular, {0, 0}, {1, 1}, 1)), std::invalid_argument);
}

TEST(Shoot, SaysThatItFailed) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  const Shot shot = shoot(fixed_ends(central, {1}, {-1}, 1));
  EXPECT_NE(shot.status, Status::converged);
  EXPECT_FALSE(shot.message.empty());
  EXPECT_THROW(follow(*central, shot, std::vector{0.5}), std::invalid_argument);
}

TEST(Follow, TimesThatAllButCoincideWithTheEndsOfSegments) {
  const Problem problem = fixed_ends(pendulum(), {0}, {1.5}, 2);
  const Shot shot = shoot(problem, {.tolerance = 1e-12, .segments = 7});
  ASSERT_TRUE(shot.converged());
  std::vector<double> times;
  for (int k = 0; k < 7; ++k)
    for (const double end :
         {std::nextafter(shot.times[k], -1), shot.times[k], std::nextafter(shot.times[k], 3)})
      if (end >= 0) times.push_back(end);
  const Flight flight = follow(*problem.lagrangian, shot, times);
  ASSERT_TRUE(flight.complete);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GE(flight.q[i], flight.q[i - 1] - 1e-11);
}

}  // namespace
}  // namespace extremal
