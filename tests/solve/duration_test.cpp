#include <numbers>

#include "solve/laws.hpp"

/// \file A duration that is unknown, closed by the energy or by where an end is.

namespace extremal::laws {
namespace {

using std::numbers::pi;

Problem at_energy(Problem problem, double energy, double guess) {
  problem.duration = {.value = guess, .free = true, .energy = energy, .where = {}};
  return make_problem(std::move(problem));
}

/// q = √(2E) sin t reaches 1 at asin(1/√(2E)) and on the way back.
TEST(FreeDuration, OscillatorAtGivenEnergy) {
  const Problem fixed = fixed_ends(systems::oscillator(1), {0}, {1}, 1);
  const Solution first = solve(at_energy(fixed, 2, 0.7), within(1e-12));
  EXPECT_NEAR(first.duration(), pi / 6, 1e-13);
  EXPECT_NEAR(*first.energy, 2, 1e-12);
  const Problem far =
      guessed(at_energy(fixed, 2, 2.4), [](double tau) { return Values{2 * std::sin(2.5 * tau)}; });
  const Solution second = solve(far, within(1e-12));
  EXPECT_NEAR(second.duration(), 5 * pi / 6, 1e-12);
  EXPECT_NEAR(second.momentum_start[0], 2, 1e-12);
}

/// Barker's equation: from the pericentre q to the true anomaly ν on a parabola, whose energy is zero,
/// T = √(2q³) (D + D³/3) with D = tan(ν/2).
TEST(FreeDuration, ParabolaHasNoEnergy) {
  const double q = 0.5, nu = 2, r = 2 * q / (1 + std::cos(nu)), D = std::tan(nu / 2);
  const Problem fixed = fixed_ends(systems::kepler(), {q, 0}, {r * std::cos(nu), r * std::sin(nu)}, 1);
  for (const SolveOptions& options : {within(1e-6), within(1e-11)}) {
    const Solution s = solve(at_energy(fixed, 0, 1.2), options);
    EXPECT_NEAR(s.duration(), std::sqrt(2 * q * q * q) * (D + D * D * D / 3), 10 * options.tolerance);
    EXPECT_NEAR(*s.energy, 0, 100 * options.tolerance);
  }
  const SolveOptions discrete = pinned(scheme("midpoint"), 40);
  EXPECT_NEAR(solve(at_energy(fixed, 0, 1.2), discrete).duration(),
              std::sqrt(2 * q * q * q) * (D + D * D * D / 3), 0.01);
}

/// Range d at speed v: sin 2θ = g d/v², T = 2 v sin θ/g; the flat throw and the steep one.
TEST(FreeDuration, ProjectileAtGivenEnergy) {
  const double g = 9.81, speed = 12, d = 10;
  const auto lagrangian =
      trace(2, [=](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 - g * q[1]; });
  const double flat = std::asin(g * d / (speed * speed)) / 2, steep = pi / 2 - flat;
  for (double angle : {flat, steep}) {
    const double T = 2 * speed * std::sin(angle) / g;
    const Problem problem = at_energy(fixed_ends(lagrangian, {0, 0}, {d, 0}, 1), speed * speed / 2, 1.1 * T);
    const Solution s = solve(problem, within(1e-12));
    EXPECT_NEAR(s.duration(), T, 1e-12);
    EXPECT_NEAR(s.momentum_start[0], speed * std::cos(angle), 1e-11);
    EXPECT_NEAR(s.momentum_start[1], speed * std::sin(angle), 1e-11);
  }
}

/// With any scheme, T is where the slope of the discrete action is −E.
TEST(FreeDuration, SlopeOfTheDiscreteActionIsMinusTheEnergy) {
  const Problem fixed = fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 0.8);
  const double energy = *solve(fixed, within(1e-12)).energy;
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : {6, 24}) {
      if (one_sided(scheme) && elements < 20) continue;  // so coarse, no path has that energy
      Problem problem = guided(fixed);
      const Solution s = solve(at_energy(problem, energy, 0.8), pinned(scheme, elements));
      const auto action = [&](double h) {
        problem.duration.value = s.duration() + h;
        return solve(problem, pinned(scheme, elements)).action;
      };
      EXPECT_NEAR(difference(action, 1e-3), -energy, 1e-9 * std::abs(energy))
          << scheme.name << ' ' << elements;
    }
}

Problem closed_by(Problem problem, EndFunction where, double guess) {
  problem.duration = {.value = guess, .free = true, .energy = {}, .where = std::move(where)};
  return make_problem(std::move(problem));
}

/// Thrown upwards, at rest at height h: T = √(2h/g).
TEST(FreeDuration, ThrowThatComesToRestWhereItShould) {
  const double g = 9.81, h = 3;
  const auto lagrangian = trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 - g * q[0]; });
  const Problem problem = closed_by(
      with_ends(lagrangian, 1, [](auto& b) { b.fix(0, false, 0); }),
      [=](auto, auto end, auto gradient) {
        gradient[0] = 0, gradient[1] = 1;
        return end[0] - h;
      },
      0.5);
  const Solution s = solve(problem, within(1e-12));
  EXPECT_NEAR(s.duration(), std::sqrt(2 * h / g), 1e-13);
  EXPECT_NEAR(s.momentum_start[0], std::sqrt(2 * g * h), 1e-12);
}

/// Released at rest at q(0) = A, where 1 − cos q(0) = 1 − cos A, through q = 0: a quarter of 4K(sin²(A/2)).
TEST(FreeDuration, PendulumReleasedWhereItShould) {
  for (double amplitude : {0.3, 1.0, 2.5}) {
    const double T = std::comp_ellint_1(std::sin(amplitude / 2));
    Problem problem = closed_by(
        with_ends(systems::pendulum(), T, [](auto& b) { b.fix(0, true, 0); }),
        [=](auto start, auto, auto gradient) {
          gradient[0] = std::sin(start[0]), gradient[1] = 0;
          return std::cos(amplitude) - std::cos(start[0]);
        },
        1.05 * T);
    problem = guessed(problem, [=](double tau) { return Values{0.95 * amplitude * std::cos(pi * tau / 2)}; });
    const Solution s = solve(problem, within(1e-12));
    EXPECT_NEAR(s.duration(), T, 2e-12 * T) << amplitude;
    EXPECT_NEAR(at(s.trajectory, 0).q[0], amplitude, 1e-12);
    EXPECT_NEAR(s.momentum_end[0], -2 * std::sin(amplitude / 2), 4e-12);
    EXPECT_LT(std::abs(s.momentum_start[0]), 1e-13);
  }
}

/// At the energy of the largest range R a throw at 45° is the only one, T = √(2R/g): the energy is least in T
/// there, a double root. It is found within the tolerance, or refused.
TEST(FreeDuration, DoubleRootAtTheLargestRange) {
  const Problem thrown =
      fixed_ends(trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 - 9.81 * q[1]; }),
                 {0, 0}, {10, 0}, 1.4);
  const double T = std::sqrt(2 * 10 / 9.81);
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-9, 1e-11}) {
    const Solution s = Solver().solve(at_energy(thrown, 49.05, 1.4), within(tolerance));
    if (s.converged()) {
      EXPECT_LE(s.error_estimate, 10 * tolerance);
      EXPECT_NEAR(s.duration(), T, 10 * tolerance * T);
    } else {
      EXPECT_LT(tolerance, 1e-8);
      EXPECT_NE(s.message.find("double root"), std::string::npos) << s.message;
    }
  }
}

}  // namespace
}  // namespace extremal::laws
