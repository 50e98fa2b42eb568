#include <numbers>

#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file Ends that are conjugate, or nearly so: a clear answer, and an error that tells the conditioning.

namespace extremal::laws {
namespace {

using std::numbers::pi;

const double tolerances[] = {1e-3, 1e-6, 1e-9, 1e-12};

/// Neither solution nor family is returned.
void expect_refused(const Problem& problem, const SolveOptions& options) {
  const Solution s = Solver().solve(problem, counted(options));
  EXPECT_EQ(s.status, Status::conjugate_ends) << options.tolerance << ": " << s.message;
  EXPECT_NE(s.message.find("conjugate"), std::string::npos);
  EXPECT_TRUE(s.trajectory.times.empty());
}

/// One of a family, which the message and the nullity tell.
void expect_member(const Problem& problem, const SolveOptions& options, int index, double action) {
  const Solution s = Solver().solve(problem, counted(options));
  ASSERT_TRUE(s.converged()) << options.tolerance << ": " << s.message;
  EXPECT_NE(s.message.find("one of a family"), std::string::npos) << s.message;
  EXPECT_EQ(s.nullity, 1);
  EXPECT_EQ(s.morse_index, index);
  EXPECT_NEAR(s.action, action, 1e-9 * std::max(1.0, action));
}

/// q(T) = 1 has no solution where T = kπ, q(T) = 0 has infinitely many: q = 0 is nearest to the line.
TEST(ConjugateEnds, OfTheOscillator) {
  for (int k : {1, 2, 5})
    for (double omega : {1.0, 2.9})
      for (double tolerance : tolerances) {
        expect_refused(fixed_ends(systems::oscillator(omega), {0}, {1}, k * pi / omega), within(tolerance));
        expect_member(fixed_ends(systems::oscillator(omega), {0}, {0}, k * pi / omega), within(tolerance),
                      k - 1, 0);
      }
}

/// From q(0) = 0 to rest a quarter of a period later: b sin t for every b. The nearest to 0.4 sin t + 0.1 sin
/// 3t in L2 is 0.4 sin t.
TEST(ConjugateEnds, OfAnOscillatorThatEndsAtRest) {
  Problem problem;
  problem.names = {"q"};
  problem.lagrangian = systems::oscillator(1);
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 0);
  problem.duration.value = pi / 2;
  for (int i = 0; i <= 100; ++i) {
    const double tau = i / 100.0, t = tau * pi / 2;
    problem.guess.tau.push_back(tau);
    problem.guess.q.push_back(0.4 * std::sin(t) + 0.1 * std::sin(3 * t));
  }
  const Solution s = Solver().solve(make_problem(problem), within(1e-9));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.nullity, 1);
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_NEAR(s.momentum_start[0], 0.4, 1e-5);  // the guess is a cubic through 101 samples
  EXPECT_NEAR(s.action, 0, 1e-12);
}

/// Free ends and forces that depend on q₁ − q₂ alone: translations move the one extremal.
TEST(FreeEnds, FamilyOfTranslationsMinimises) {
  Problem problem;
  problem.names = {"x", "y"};
  problem.lagrangian = trace(2, [](auto q, auto v, auto) {
    const auto stretch = q[0] - q[1] - 1;
    return (v[0] * v[0] + v[1] * v[1] + stretch * stretch) / 2;
  });
  problem.boundary.coordinates = 2;
  problem.duration.value = 1;
  problem.guess.tau = {0, 1};
  problem.guess.q = {0.4, 0.1, 0.4, 0.1};
  const Solution s = Solver().solve(make_problem(problem), within(1e-9));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_EQ(s.nullity, 1);
  EXPECT_TRUE(s.minimizing);
}

std::shared_ptr<const Lagrangian> sphere() {
  return trace(2, [](auto q, auto v, auto) {
    const auto c = cos(q[0]);
    return (v[0] * v[0] + c * c * v[1] * v[1]) / 2;
  });
}

/// Latitude and longitude along the great circle of this length and inclination, in time 1.
Guess great_circle(double length, double tilt) {
  Guess guess;
  for (int i = 0; i <= 100; ++i) {
    const double s = length * i / 100;
    guess.tau.push_back(i / 100.0);
    guess.q.push_back(std::asin(std::sin(tilt) * std::sin(s)));
    guess.q.push_back(std::atan2(std::cos(tilt) * std::sin(s), std::cos(s)));
  }
  return guess;
}

TEST(ConjugateEnds, OfAntipodes) {
  for (double tolerance : tolerances) {
    expect_member(fixed_ends(sphere(), {0, 0}, {0, pi}, 1), within(tolerance), 0, pi * pi / 2);
    Problem tilted = fixed_ends(sphere(), {0, 0}, {0, pi}, 1);
    tilted.guess = great_circle(pi, 0.5);
    expect_member(make_problem(tilted), within(tolerance), 0, pi * pi / 2);
  }
}

/// Over 180 degrees about a centre of gravity, the plane is free, and the straight line hits the centre. In
/// half the period of an ellipse of major semi-axis a it is that ellipse's half, along which S = ∫ (−1/2a +
/// 2/r) dt = 3/2 π √a.
TEST(ConjugateEnds, OfHohmannsTransferInSpace) {
  LONG_TEST();
  const auto kepler = trace(3, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  });
  const double a = 1.25;
  for (const auto& u : {Values{1, 0, 0}, Values{0, 0, 1}, Values{0.6, 0.8, 0}})
    expect_member(fixed_ends(kepler, u, {-1.5 * u[0], -1.5 * u[1], -1.5 * u[2]}, pi * std::pow(a, 1.5)),
                  within(1e-9), 0, 1.5 * pi * std::sqrt(a));
}

/// Exactly so many elements do not hide it.
TEST(ConjugateEnds, OfAPinnedScheme) {
  expect_refused(fixed_ends(systems::oscillator(1), {0}, {0}, pi), pinned(lobatto(6), 8));
  expect_refused(fixed_ends(systems::oscillator(1), {0}, {1}, pi), pinned(scheme("midpoint"), 64));
}

/// q = sin t/sin T near T = kπ: what is returned has the error that it tells, within a factor of 10, or at
/// least not more; or nothing is returned.
TEST(NearlyConjugateEnds, TellTheErrorOfTheOscillator) {
  int converged = 0;
  for (int k : {1, 3})
    for (double tolerance : tolerances)
      for (double distance : {1e-3, -1e-3, 1e-5, -1e-5, 1e-7, -1e-7}) {
        const double T = k * pi * (1 + distance);
        const Solution s = Solver().solve(fixed_ends(systems::oscillator(1), {0}, {1}, T), within(tolerance));
        if (!s.converged()) {
          EXPECT_NE(s.message.find("conjugate"), std::string::npos) << s.message;
          continue;
        }
        ++converged;
        const double truth = std::sin(T), size = (k > 1 ? 2 : 1) / std::abs(truth);
        const double error =
            laws::distance(s.trajectory, [&](double t) { return Values{std::sin(t) / truth}; });
        EXPECT_LT(error, 10 * s.error_estimate) << k << ' ' << tolerance << ' ' << distance;
        EXPECT_LT(error, tolerance * size) << k << ' ' << tolerance << ' ' << distance;
        EXPECT_LT(s.error_estimate, 1.1 * tolerance * size) << k << ' ' << tolerance << ' ' << distance;
        EXPECT_EQ(s.morse_index, distance > 0 ? k : k - 1);
        EXPECT_EQ(s.conjugate_times.size(), *s.morse_index);
      }
  EXPECT_GE(converged, 36);
}

/// Nearly antipodal points: the great circle between them, tilted by what separates them from the equator.
TEST(NearlyConjugateEnds, TellTheErrorOfGreatCircles) {
  int converged = 0;
  for (double tolerance : tolerances)
    for (double distance : {1e-3, 1e-5, 1e-7}) {
      const double length = pi - distance, tilt = 0.5;
      Problem problem = fixed_ends(sphere(), {0, 0},
                                   {std::asin(std::sin(tilt) * std::sin(distance)),
                                    pi - std::atan2(std::cos(tilt) * std::sin(distance), std::cos(distance))},
                                   1);
      problem.guess = great_circle(length, 0.6);
      const Solution s = Solver().solve(make_problem(problem), within(tolerance));
      if (!s.converged()) continue;
      ++converged;
      const double error = laws::distance(s.trajectory, [&](double t) {
        const double x = std::cos(length * t), y = std::sin(length * t);
        return Values{std::asin(std::sin(tilt) * y), std::atan2(std::cos(tilt) * y, x)};
      });
      EXPECT_LT(error, 10 * s.error_estimate + 1e-15 / distance) << tolerance << ' ' << distance;
      EXPECT_EQ(s.morse_index, 0);
      EXPECT_TRUE(s.minimizing);
    }
  EXPECT_GE(converged, 7);
}

/// Not both ends fixed: that they are conjugate as if they were is no obstacle. Periodic, T = π and 2π/ω.
TEST(SingularChain, IsNoObstacleWhereEndsAreFree) {
  const auto lagrangian =
      trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2 + 0.3 * q[0]; });
  const auto periodic = [](auto& b) {
    const int row = b.add_row(0);
    b.add(row, 0, -1);
    b.add(row, 1, 1);
  };
  for (double tolerance : tolerances) {
    for (double T : {pi, 3 * pi}) {
      const Solution s = solve(with_ends(lagrangian, T, periodic), within(tolerance));
      EXPECT_LT(distance(s.trajectory, [](double) { return Values{0.3}; }), 1e-12);
      EXPECT_EQ(s.morse_index, 2 * std::floor(T / (2 * pi)) + 1);
      EXPECT_EQ(s.nullity, 0);
    }
    // One end natural: q = 0.3 + (q(0) − 0.3) cos t/…, q'(T) = 0 at T = π.
    const Solution s =
        solve(with_ends(lagrangian, pi, [](auto& b) { b.fix(0, false, 1); }), within(tolerance));
    EXPECT_LT(distance(s.trajectory, [](double t) { return Values{0.3 + 0.7 * std::cos(t)}; }), tolerance);
    EXPECT_EQ(s.morse_index, 1);
  }
}

/// Every solution of the oscillator closes after T = 2π: of the family the nearest to the guess.
TEST(SingularChain, AFamilyGivesTheNearest) {
  Problem problem;
  problem.lagrangian = systems::oscillator(1);
  problem.names = {"q"};
  problem.boundary.coordinates = 1;
  problem.periodic = true;
  const int row = problem.boundary.add_row(0);
  problem.boundary.add(row, 0, -1);
  problem.boundary.add(row, 1, 1);
  problem.duration.value = 2 * pi;
  problem =
      guessed(make_problem(problem), [](double tau) { return Values{0.5 * std::cos(2 * pi * tau + 0.3)}; });
  const Solution s = solve(problem, within(1e-9));
  EXPECT_EQ(s.morse_index, 1);
  EXPECT_EQ(s.nullity, 2);
  EXPECT_LT(distance(s.trajectory, [](double t) { return Values{0.5 * std::cos(t + 0.3)}; }), 1e-4);
}

}  // namespace
}  // namespace extremal::laws
