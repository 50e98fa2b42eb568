#include <numbers>

#include "solve/laws.hpp"

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

/// Far from degeneracy and well resolved, every discretisation has the index of the continuous problem.
TEST(MorseIndex, OfPinnedSchemesOnAFineMesh) {
  for (const Scheme& scheme : schemes_and_families()) {
    const Problem problem = fixed_ends(oscillators({1.0}), {0}, {1}, 7.0);
    EXPECT_EQ(solve(problem, pinned(scheme, 60)).morse_index, 2) << scheme.name;
    EXPECT_EQ(solve(with_free_ends(problem), pinned(scheme, 60)).morse_index, 3) << scheme.name;
  }
}

}  // namespace
}  // namespace extremal::laws
