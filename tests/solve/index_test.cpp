#include <numbers>

#include "solve/laws.hpp"
#include "solve/scenes.hpp"

/// \file The Morse index of the oscillator: ⌈Tω/π⌉ − 1 with fixed ends, ⌊Tω/π⌋ + 1 with free ones.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// Several frequencies, pushed by a force so that the solution is not the equilibrium.
std::shared_ptr<const Lagrangian> oscillators(const Values& omega) {
  return trace(static_cast<int>(omega.size()), [&](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (std::size_t i = 0; i < omega.size(); ++i)
      l += (v[i] * v[i] - omega[i] * omega[i] * q[i] * q[i]) / 2 + 0.3 * q[i];
    return l;
  });
}

Problem with_free_ends(Problem problem) {
  const int n = problem.coordinates();
  problem.boundary = {};
  problem.boundary.coordinates = n;
  problem.guess.tau = {0, 0.5, 1};
  problem.guess.q.assign(3 * n, 0.5);
  return make_problem(std::move(problem));
}

/// Distance of Tω/π from a whole number, where the second variation degenerates.
bool degenerate(double phase) { return std::abs(phase - std::round(phase)) < 0.02; }

const double durations[] = {0.5, 1.7, 3.3, 6.1, 10.3, 24.4, 49.7, 100};

TEST(MorseIndex, OfOneOscillator) {
  for (double omega : {0.31, 1.0, 1.37, 2.9})
    for (double T : durations) {
      const double phase = T * omega / pi;
      if (degenerate(phase)) continue;
      const Problem problem = fixed_ends(oscillators({omega}), {0}, {1}, T);
      const Solution fixed = solve(problem, within(1e-9));
      EXPECT_EQ(fixed.morse_index, std::ceil(phase) - 1) << omega << ' ' << T;
      EXPECT_EQ(fixed.minimizing, phase < 1);
      EXPECT_EQ(fixed.nullity, 0) << omega << ' ' << T;
      const Solution free = solve(with_free_ends(problem), within(1e-9));
      EXPECT_EQ(free.morse_index, std::floor(phase) + 1) << omega << ' ' << T;
      EXPECT_FALSE(free.minimizing);
    }
}

TEST(MorseIndex, IsASumOverFrequencies) {
  const Values omega{0.7, 1.3, 2.1};
  for (double T : durations) {
    int fixed = 0, free = 0;
    bool skip = false;
    for (double w : omega) {
      const double phase = T * w / pi;
      skip = skip || degenerate(phase);
      fixed += static_cast<int>(std::ceil(phase)) - 1;
      free += static_cast<int>(std::floor(phase)) + 1;
    }
    if (skip) continue;
    const Problem problem = fixed_ends(oscillators(omega), {0, 0, 0}, {1, -0.5, 0.3}, T);
    EXPECT_EQ(solve(problem, within(1e-9)).morse_index, fixed) << T;
    EXPECT_EQ(solve(with_free_ends(problem), within(1e-9)).morse_index, free) << T;
  }
}

/// Periodic ends: 2⌊Tω/2π⌋ + 1.
TEST(MorseIndex, OfPeriodicEnds) {
  for (double T : durations) {
    const double phase = T * 1.37 / (2 * pi);
    if (degenerate(phase)) continue;
    Problem problem = with_free_ends(fixed_ends(oscillators({1.37}), {0}, {1}, T));
    const int row = problem.boundary.add_row(0);
    problem.boundary.add(row, 0, -1);
    problem.boundary.add(row, 1, 1);
    const Solution s = solve(make_problem(problem), within(1e-9));
    EXPECT_EQ(s.morse_index, 2 * std::floor(phase) + 1) << T;
  }
}

/// One coordinate closed, one free at both ends, one fixed at the start: each counts as it would alone. Fixed
/// at one end: ⌊Tω/π + 1/2⌋.
TEST(MorseIndex, OfMixedEnds) {
  const Values omega{0.7, 1.3, 2.1};
  for (double T : durations) {
    const double closed = T * omega[0] / (2 * pi), free = T * omega[1] / pi, fixed = T * omega[2] / pi + 0.5;
    if (degenerate(closed) || degenerate(free) || degenerate(fixed)) continue;
    const Solution s = solve(with_ends(oscillators(omega), T,
                                       [](auto& b) {
                                         const int row = b.add_row(0);
                                         b.add(row, 0, -1);
                                         b.add(row, 3, 1);
                                         b.fix(2, false, 1);
                                       }),
                             within(1e-9));
    EXPECT_EQ(s.morse_index, 2 * std::floor(closed) + 1 + std::floor(free) + 1 + std::floor(fixed)) << T;
    EXPECT_EQ(s.nullity, 0);
  }
}

/// A motion along x says nothing of how fast y may swing; the elements must know it all the same.
TEST(MorseIndex, OfWhatAGuessDoesNotShow) {
  Problem problem = with_ends(
      trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1] - 40000 * q[1] * q[1]) / 2; }), 1,
      [](auto& b) {
        b.fix(0, false, 0);
        b.fix(0, true, 1);
      });
  for (int k = 0; k <= 320; ++k) {
    problem.guess.tau.push_back(k / 320.0);
    problem.guess.q.insert(problem.guess.q.end(), {k / 320.0, 0});
  }
  problem.guess.samples_a_step = 64;
  const Solution s = solve(make_problem(problem), within(1e-9));
  EXPECT_EQ(s.morse_index, std::floor(200 / pi) + 1);
}

/// Rotations leave the centre where it is, and have no null direction there. Of q = Re c exp(2πikt/T) in a
/// frame that turns with W the action is positive where (2πk/T ± W)² > 1.
TEST(MorseIndex, OfRestInARotatingFrame) {
  for (const double W : {0.3, 0.7})
    for (const double T : {2.0, 3.0, 4.0}) {
      const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
        const auto x = v[0] - W * q[1], y = v[1] + W * q[0];
        return (x * x + y * y - q[0] * q[0] - q[1] * q[1]) / 2;
      });
      int index = 2;
      for (int k = 1; k < 10; ++k) index += 2 * (std::abs(2 * pi * k / T - W) < 1);
      const Solution s = solve(guessed(periodic(lagrangian, T),
                                       [](double) {
                                         return Values{0, 0};
                                       }),
                               within(1e-9));
      EXPECT_EQ(s.morse_index, index) << W << ' ' << T;
      EXPECT_EQ(s.nullity, 0) << W << ' ' << T;
    }
}

/// In the plane, with T fixed: time shift, rotation, and the family of ellipses with the same period.
TEST(Nullity, OfPeriodicKeplerOrbitsIsThree) {
  for (double e : {0.0, 0.3, 0.6})
    for (double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
      if (e == 0.6 && tolerance == 1e-3) continue;  // no orbit is found on so coarse a mesh
      Problem problem = with_ends(systems::kepler(), 2 * pi, [](auto& b) {
        for (int a : {0, 1}) {
          const int row = b.add_row(0);
          b.add(row, a, -1);
          b.add(row, 2 + a, 1);
        }
      });
      problem.periodic = true;
      problem = guessed(problem, [=](double tau) {
        const double E = 2 * pi * tau;
        return Values{std::cos(E) - e, std::sqrt(1 - e * e) * std::sin(E)};
      });
      const Solution s = solve(problem, within(tolerance));
      EXPECT_EQ(s.nullity, 3) << e << ' ' << tolerance;
      EXPECT_EQ(s.morse_index, 0) << e << ' ' << tolerance;
      EXPECT_TRUE(s.minimizing);
    }
}

/// Two translations, rotation, time shift.
TEST(Nullity, OfTheFigureEightIsFour) {
  for (double tolerance : {1e-3, 1e-5, 1e-9, 1e-11}) {
    Study study = load(bench_data("figure-eight.toml"));
    study.options.tolerance = tolerance;
    const Solution s = run(study);
    EXPECT_EQ(s.nullity, 4) << tolerance;
    EXPECT_EQ(s.morse_index, 2) << tolerance;
  }
}

/// Far from degeneracy and well resolved, every discretisation has the index of the continuous problem.
TEST(MorseIndex, OfPinnedSchemesOnAFineMesh) {
  for (const Scheme& scheme : schemes_and_families()) {
    const Problem problem = fixed_ends(oscillators({1.0}), {0}, {1}, 7.0);
    EXPECT_EQ(solve(problem, pinned(scheme, 60)).morse_index, 2) << scheme.name;
    EXPECT_EQ(solve(with_free_ends(problem), pinned(scheme, 60)).morse_index, 3) << scheme.name;
  }
}

/// Elements so short that the error of the trajectory is more than an element adds to what its ends feel.
TEST(MorseIndex, OfShortElementsOfLowOrder) {
  const Problem problem = with_ends(oscillators(Values(9, 1)), 5, [](BoundaryRelation& b) {
    for (int a = 0; a < 9; ++a) b.fix(a, true, 0.5);
  });
  const Solution s = Solver().solve(problem, pinned(scheme("rectangle-right"), 8000));
  EXPECT_EQ(s.morse_index, 9 * 2);  // ⌊T/π + 1/2⌋, one end free
  EXPECT_EQ(s.nullity, 0);
}

/// The length of a path, all but independent of the speed along it: mass across is 1, along it 1e-12.
TEST(MorseIndex, IsNotToldWithoutNullity) {
  const Study study = study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"sqrt(x'^2 + y'^2 + 1e-12)\"\n[boundary]\n"
      "conditions = [\"x(0)^2 + y(0)^2 = 1\", \"(x(T) - 3)^2 + (y(T) - 1)^2 = 0.25\"]\nduration = 1.4\n");
  const Solution s = run(study);
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, std::sqrt(10) - 1.5, 1e-9);
  EXPECT_FALSE(s.morse_index);
  EXPECT_FALSE(s.nullity);
}

}  // namespace
}  // namespace extremal::laws
