#include <numbers>

#include "solve/scenes.hpp"

/// \file Periodic orbits: their phase, what they are distinguished from, what is said of them.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// Swings of period T/turns, begun anywhere.
Problem swings(double T, double amplitude, int turns, double phase) {
  return guessed(periodic(systems::pendulum(), T),
                 [=](double tau) { return Values{amplitude * std::sin(2 * pi * turns * tau + phase)}; });
}

/// Elements prefer a phase, by as much as they err; the orbit, its index and its nullity do not depend on it.
TEST(Periodic, AnyPhase) {
  const double T = 9;  // frequency 1
  const Solution reference = solve(swings(T, 2, 1, 0), within(1e-12));
  for (double phase : {0.0, 0.3, 1.0, 2.2, 4.0})
    for (double tolerance : {1e-3, 1e-5, 1e-8, 1e-11}) {
      const Solution s = solve(swings(T, 2, 1, phase), within(tolerance));
      EXPECT_EQ(s.strategy, "newton from the guess") << phase << " " << tolerance;
      EXPECT_EQ(s.morse_index, 1) << phase << " " << tolerance;
      EXPECT_EQ(s.nullity, 1) << phase << " " << tolerance;
      EXPECT_NEAR(s.action, reference.action, 20 * tolerance) << phase << " " << tolerance;
      EXPECT_LT(s.residual, 1e-7);
    }
}

/// It stays near the guess's phase, or the time shift would be found again in q(0).
TEST(Periodic, NearTheGuess) {
  for (double phase : {0.3, 1.0, 2.2}) {
    const Solution s = solve(swings(9, 2, 1, phase), within(1e-10));
    double distance = 0;
    for (int k = 0; k < 100; ++k) {
      const double tau = k / 100.0;
      distance += at(s.trajectory, tau * s.duration()).v[0] * 2 * std::sin(2 * pi * tau + phase) / 100;
    }
    EXPECT_NEAR(distance, 0, 0.2) << phase;  // ∫q'·guess dt = 0 where the distance is least
  }
}

/// Energy from dq/dt alone: T = ∫dq/√(2(E + cos q)) over a turn.
TEST(Periodic, RotatingPendulum) {
  for (double T : {0.5, 2.0, 4.0, 8.0}) {
    const Problem problem =
        guessed(periodic(systems::pendulum(), T, 2 * pi), [](double tau) { return Values{2 * pi * tau}; });
    const Solution s = solve(problem, within(1e-11));
    EXPECT_EQ(s.morse_index, 0);
    EXPECT_EQ(s.nullity, 1);
    double turn = 0;
    const int points = 20000;  // exponentially accurate for a periodic integrand
    for (int k = 0; k < points; ++k)
      turn += 2 * pi / points / std::sqrt(2 * (*s.energy + std::cos(2 * pi * k / points)));
    EXPECT_NEAR(turn / T, 1, 1e-8) << T;
  }
}

/// The guess is 0.5 % off; another orbit, unstable and of index 3, is near. Action of the reference orbit.
TEST(Periodic, FigureEightAndNotItsNeighbour) {
  for (const char* scene : {"figure-eight-near.toml", "figure-eight.toml"})
    for (double tolerance : {1e-4, 1e-8, 1e-11}) {
      Study study = load(bench_data(scene));
      study.options.tolerance = tolerance;
      const Solution s = run(study);
      ASSERT_TRUE(s.converged()) << s.message;
      EXPECT_EQ(s.strategy, "newton from the guess");
      EXPECT_NEAR(s.action, 24.4270486, 3 * tolerance + 1e-7) << scene << " " << tolerance;
      EXPECT_EQ(s.morse_index, 2);
      EXPECT_EQ(s.nullity, 4);
      // Coarse elements would go astray along the softest direction, and finer ones all the way back.
      EXPECT_LE(s.iterations, scene == std::string("figure-eight-near.toml") ? 12 : 20) << tolerance;
    }
}

TEST(Periodic, MinimalPeriod) {
  for (int turns : {1, 2, 3, 6}) {
    const Solution s = solve(swings(9.0 * turns, 2, turns, 0.4), within(1e-9));
    EXPECT_NEAR(s.minimal_period.value(), 9, 1e-12) << turns;
  }
  EXPECT_FALSE(solve(fixed_ends(systems::pendulum(), {0}, {1}, 1), within(1e-9)).minimal_period);
}

/// x'' = x + f has the solution of the period of f alone, here a sum of sines of angular frequency 2πk.
TEST(Periodic, MinimalPeriodOfForcedOrbits) {
  struct Sine {
    int k;
    double size;
  };
  const auto period = [](const std::vector<Sine>& sum) {
    const auto lagrangian = trace(1, [&](auto q, auto v, auto t) {
      auto l = (v[0] * v[0] + q[0] * q[0]) / 2;
      for (const Sine& s : sum) l = l - s.size * (4 * pi * pi * s.k * s.k + 1) * sin(2 * pi * s.k * t) * q[0];
      return l;
    });
    const auto orbit = [&](double tau) {
      double x = 0;
      for (const Sine& s : sum) x += s.size * std::sin(2 * pi * s.k * tau);
      return Values{x};
    };
    const Solution s = solve(guessed(periodic(lagrangian, 1), orbit), within(1e-8));
    EXPECT_TRUE(s.converged()) << s.message;
    return s.minimal_period.value_or(0);
  };
  EXPECT_NEAR(period({{37, 1}}), 1.0 / 37, 1e-12);
  EXPECT_NEAR(period({{6, 1}, {10, 0.5}}), 0.5, 1e-12);
  EXPECT_NEAR(period({{2, 1}, {1, 0.5}, {65, -0.5}}), 1, 1e-12);  // a half but for what is 0 at t = k/64
}

/// No swing is shorter than 2π.
TEST(Periodic, CollapseOntoAnEquilibriumIsAFailure) {
  const Solution s = Solver().solve(swings(3, 0.5, 1, 0.2), within(1e-8));
  EXPECT_EQ(s.status, Status::no_solution_near);
  EXPECT_NE(s.message.find("equilibrium"), std::string::npos) << s.message;
  EXPECT_TRUE(s.trajectory.nodes.empty());
}

/// A discretisation that is asked for is stationary, in a phase that it prefers.
TEST(Periodic, PinnedSchemesAreStationary) {
  for (const char* name : {"midpoint", "lobatto(2)", "gauss(2)", "lobatto(4)"}) {
    const Solution s = solve(swings(9, 2, 1, 0.3), pinned(scheme(name), 24));
    EXPECT_LT(s.residual, 1e-10) << name;
  }
}

/// x'²/2 + (1.7 + 0.1 cos t) cos x: the pendulum that hangs has every period, and no orbit is near.
TEST(Periodic, DrivenOrbitsThatShrinkToRestAreNone) {
  const auto swung =
      trace(1, [](auto q, auto v, auto t) { return v[0] * v[0] / 2 + (1.7 + 0.1 * cos(t)) * cos(q[0]); });
  const auto guess = [](double size) {
    return [size](double tau) { return Values{size * std::cos(2 * pi * tau)}; };
  };
  Solver solver;
  for (const SolveOptions& options :
       {within(1e-3), within(1e-9), within(1e-12), pinned(scheme("midpoint"), 64), pinned(gauss(4), 10)}) {
    const Solution s = solver.solve(guessed(periodic(swung, 2 * pi), guess(0.02)), options);
    EXPECT_FALSE(s.converged() && largest(s.trajectory.nodes) < 1e-3) << s.message;
  }
  // Who asks for rest gets it.
  const Solution rest = solve(guessed(periodic(swung, 2 * pi), guess(0)), within(1e-9));
  EXPECT_LT(largest(rest.trajectory.nodes), 1e-12);
}

/// The collinear point L2 of the elliptic restricted problem in a frame that pulsates, where it rests.
TEST(Periodic, PointsOfLibrationAreNoOrbits) {
  static constexpr double mu = 0.01215;
  const auto elliptic = trace(2, [](auto q, auto v, auto t) {
    constexpr double e = 0.0549;
    const auto far = sqrt((q[0] + mu) * (q[0] + mu) + q[1] * q[1]),
               near = sqrt((q[0] - 1 + mu) * (q[0] - 1 + mu) + q[1] * q[1]);
    return (v[0] * v[0] + v[1] * v[1]) / 2 + q[0] * v[1] - q[1] * v[0] +
           ((q[0] * q[0] + q[1] * q[1]) / 2 + (1 - mu) / far + mu / near) / (1 + e * cos(t));
  });
  for (const double size : {0.03, 0.13}) {
    const Problem problem = guessed(periodic(elliptic, 2 * pi), [size](double tau) {
      return Values{1.1556822 - size * std::cos(4 * pi * tau), 3 * size * std::sin(4 * pi * tau)};
    });
    for (const SolveOptions& options : {within(1e-6), within(1e-9), pinned(gauss(4), 20)}) {
      const Solution s = Solver().solve(problem, options);
      if (!s.converged()) {
        EXPECT_NE(s.message.find("equilibrium"), std::string::npos) << s.message;
        continue;
      }
      double low = INFINITY, high = -INFINITY;
      for (std::size_t k = 0; k < s.trajectory.nodes.size(); k += 2) {
        low = std::min(low, s.trajectory.nodes[k]);
        high = std::max(high, s.trajectory.nodes[k]);
      }
      EXPECT_GT(high - low, 1e-3);
    }
  }
}

/// x'' + 5x = f cos t: however weak the drive, x = f cos(t)/4 is an orbit.
TEST(Periodic, WeakDrives) {
  for (const double f : {1.0, 1e-3, 1e-8}) {
    const auto driven = trace(
        1, [f](auto q, auto v, auto t) { return v[0] * v[0] / 2 - 2.5 * q[0] * q[0] + f * q[0] * cos(t); });
    const Solution s =
        solve(guessed(periodic(driven, 2 * pi), [](double tau) { return Values{std::cos(2 * pi * tau)}; }),
              within(1e-9));
    for (const double t : {0.0, 1.0, 2.5})
      EXPECT_NEAR(at(s.trajectory, t).q[0], f * std::cos(t) / 4, 2e-9 * f);
  }
}

}  // namespace
}  // namespace extremal::laws
