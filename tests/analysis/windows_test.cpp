#include <numbers>

#include "analysis/independent.hpp"
#include "analysis/variation.hpp"

/// \file Windows cover the trajectory, each is minimising, no two neighbours are; and what is claimed of
/// them.

namespace extremal::laws {
namespace {

using std::numbers::pi;

TEST(Windows, AreMinimisingAndNoTwoNeighboursAre) {
  const std::vector<Problem> problems = {
      fixed_ends(systems::pendulum(), {0.3}, {1.5}, 1),
      fixed_ends(systems::pendulum(), {0.3}, {1.5}, 20),
      fixed_ends(systems::magnetic(), {0.3, -0.2}, {0.2, 0.5}, 9),
      guessed(fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 2),
              [](double tau) {
                return Values{0.5 - 0.7 * tau, 0.5 - 0.8 * tau};
              }),
      with_ends(systems::oscillator(1.3), 11, [](auto& b) { b.fix(0, false, 0.7); }),
  };
  for (const Problem& problem : problems) {
    const Solution s = solve(problem, within(1e-10));
    EXPECT_EQ(s.certificate, Certificate::sampled);
    expect_windows(s, problem.lagrangian);
  }
}

/// Of a driven system the index is not that of the same ends later; what remains is that they abut.
TEST(Windows, OfADrivenSystem) {
  const Problem problem = fixed_ends(systems::driven(), {0}, {1}, 9);
  expect_windows(solve(problem, within(1e-10)), problem.lagrangian, false);
}

TEST(Windows, OfTheOscillatorAreHalfPeriods) {
  for (double omega : {0.4, 1.0, 2.7})
    for (double T : {1.0, 4.0, 33.0}) {
      const Solution s = solve(fixed_ends(systems::oscillator(omega), {0}, {1}, T), within(1e-9));
      ASSERT_EQ(s.windows.size(), std::ceil(T * omega / pi));
      for (std::size_t k = 0; k + 1 < s.windows.size(); ++k) {
        EXPECT_LT(s.windows[k][1] - s.windows[k][0], pi / omega);
        EXPECT_GT(s.windows[k + 1][1] - s.windows[k][0], pi / omega);
      }
    }
}

/// n masses in a line between walls, all springs 1, have ω_j = 2 sin(jπ/(2n + 2)): the fastest mode makes the
/// windows, conjugate times k π/ω_j.
void expect_normal_modes(int n, double T, const std::vector<double>& omega, const Problem& problem) {
  const Solution s = solve(problem, within(1e-8));
  ASSERT_TRUE(s.converged()) << s.message;
  std::vector<double> times;
  for (const double w : omega)
    for (int k = 1; k * pi / w < T; ++k) times.push_back(k * pi / w);
  std::sort(times.begin(), times.end());
  ASSERT_TRUE(s.conjugate_times_known) << s.message;
  ASSERT_EQ(s.conjugate_times.size(), times.size()) << n;
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(s.conjugate_times[k], times[k], 2e-9) << k;
  EXPECT_EQ(s.morse_index, static_cast<int>(times.size()));
  const double window = pi / *std::max_element(omega.begin(), omega.end());
  ASSERT_EQ(s.windows.size(), std::ceil(T / window));
  for (std::size_t k = 0; k + 1 < s.windows.size(); ++k)
    EXPECT_NEAR(s.windows[k][1] - s.windows[k][0], window, 3e-6);
  EXPECT_EQ(s.windows.back()[1], T);
}

Problem line_of_masses(int n, double T) {
  const auto lagrangian = trace(n, [n](auto q, auto v, auto) {
    auto l = v[0] * v[0] / 2 - (q[0] * q[0] + q[n - 1] * q[n - 1]) / 2;
    for (int a = 1; a < n; ++a) l = l + v[a] * v[a] / 2 - (q[a] - q[a - 1]) * (q[a] - q[a - 1]) / 2;
    return l;
  });
  Values start(n), end(n);
  for (int a = 0; a < n; ++a) start[a] = std::sin(0.1 * a), end[a] = std::cos(0.2 * a);
  return fixed_ends(lagrangian, start, end, T);
}

std::vector<double> frequencies_of_line(int n) {
  std::vector<double> omega(n);
  for (int a = 0; a < n; ++a) omega[a] = 2 * std::sin((a + 1) * pi / (2 * n + 2));
  return omega;
}

TEST(Windows, OfManyCoordinates) {
  constexpr double T = 4;
  for (const int n : {60, 100, 150}) expect_normal_modes(n, T, frequencies_of_line(n), line_of_masses(n, T));
}

/// All conjugate times would take minutes: they are counted, and windows are found without them.
TEST(Windows, OfVeryManyCoordinates) {
  constexpr int n = 700;
  const std::vector<double> omega = frequencies_of_line(n);
  const double window = pi / omega.back();
  for (const double T : {1.5, 1.6, 7.0}) {
    const Solution s = solve(line_of_masses(n, T), within(1e-8));
    ASSERT_TRUE(s.converged()) << s.message;
    int times = 0;
    for (const double w : omega) times += static_cast<int>(T * w / pi);
    EXPECT_EQ(s.morse_index, times);
    EXPECT_EQ(s.conjugate_times_known, times == 0);
    ASSERT_EQ(s.windows.size(), std::ceil(T / window));
    EXPECT_EQ(s.windows.back()[1], T);
    for (std::size_t k = 0; k + 1 < s.windows.size(); ++k) {
      EXPECT_EQ(s.windows[k][1], s.windows[k + 1][0]);
      EXPECT_LT(s.windows[k][1] - s.windows[k][0], window);
      EXPECT_GT(s.windows[k][1] - s.windows[k][0], 0.999 * window);
    }
  }
}

/// Uncoupled, of two frequencies: conjugate times of a high multiplicity, and masses that are no unit.
TEST(Windows, OfManyEqualCoordinates) {
  constexpr int n = 200;
  constexpr double T = 5;
  const auto lagrangian = trace(n, [](auto q, auto v, auto) {
    auto l = v[0] * v[0] - q[0] * q[0];
    for (int a = 1; a < n; ++a) l = l + (1.0 + a) * (v[a] * v[a] - (a % 3 == 0 ? 1.0 : 2.0) * q[a] * q[a]);
    return l;
  });
  Values start(n), end(n);
  std::vector<double> omega(n);
  for (int a = 0; a < n; ++a) {
    start[a] = std::sin(0.1 * a), end[a] = std::cos(0.2 * a);
    omega[a] = a % 3 == 0 ? 1 : std::sqrt(2.0);
  }
  expect_normal_modes(n, T, omega, fixed_ends(lagrangian, start, end, T));
}

/// Elements of a pinned scheme may be too long by far for the fields along them: the effort is bounded. The
/// scheme itself has a second variation all the same, and as many conjugate times as its index is.
TEST(Windows, WhereFieldsVaryTooFast) {
  const Problem problem = fixed_ends(systems::oscillator(1e5), {0}, {1}, 1);
  const Solution s = solve(problem, pinned(scheme("midpoint"), 32));
  SecondVariation along;
  EXPECT_FALSE(along.assemble(problem.lagrangian, s.trajectory));
  EXPECT_TRUE(along.too_many());
  EXPECT_EQ(std::ssize(s.conjugate_times), s.morse_index);
  EXPECT_FALSE(s.windows.empty());
}

/// The second variation is positive definite up to the conjugate time, exclusively.
TEST(Windows, EndBeforeTheConjugateTime) {
  for (double T : {pi * (1 - 1e-5), pi * (1 + 1e-5)}) {
    const Solution s = solve(fixed_ends(systems::oscillator(1), {0}, {1}, T), within(1e-6));
    EXPECT_EQ(s.windows.size(), T < pi ? 1 : 2);
    EXPECT_EQ(s.minimizing, T < pi);
  }
}

/// Masses of both signs: however short, no part of a trajectory is a minimum.
TEST(Windows, AreNoneWhereTheKineticEnergyIsIndefinite) {
  const auto lagrangian = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] - v[1] * v[1]) / 2 - q[0] * q[0] / 2 + q[0] * q[1];
  });
  const Solution s = solve(fixed_ends(lagrangian, {0, 0}, {1, 0.5}, 1), within(1e-9));
  EXPECT_TRUE(s.windows.empty());
  EXPECT_FALSE(s.minimizing);
  EXPECT_EQ(s.certificate, Certificate::none);
  EXPECT_NE(s.message.find("not positive definite"), std::string::npos);
}

Problem bounded(Problem problem, double curvature) {
  problem.curvature = curvature;
  return problem;
}

/// The pendulum has V'' = cos q ≤ 1: windows shorter than π are global minima, also where the local bound is
/// weaker.
TEST(Certificate, IsGlobalWhereCurvatureBoundsThePotential) {
  const Problem problem = fixed_ends(systems::pendulum(), {0.3}, {2.5}, 20);
  const Solution s = solve(bounded(problem, 1), within(1e-9));
  EXPECT_EQ(s.certificate, Certificate::global);
  EXPECT_EQ(s.windows.size(), 7);
  for (std::size_t k = 0; k < s.windows.size(); ++k) {
    EXPECT_LT(s.windows[k][1] - s.windows[k][0], pi);
    if (k > 0) {
      EXPECT_GT(s.windows[k][1] - s.windows[k - 1][0], pi);
    }
  }
  EXPECT_LT(solve(problem, within(1e-9)).windows.size(), 7);
  const Solution short_one =
      solve(bounded(fixed_ends(systems::pendulum(), {0.3}, {1.5}, 2), 1), within(1e-9));
  EXPECT_EQ(short_one.certificate, Certificate::global);
  EXPECT_EQ(short_one.windows, (std::vector<std::array<double, 2>>{{0, 2}}));
}

/// V'' ≤ 0: one window, however long.
TEST(Certificate, OfAConcavePotentialIsOneWindow) {
  const auto lagrangian = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] + q[0] * q[0]) / 2; });
  const Solution s = solve(bounded(fixed_ends(lagrangian, {0}, {1}, 30), 0), within(1e-9));
  EXPECT_EQ(s.certificate, Certificate::global);
  EXPECT_EQ(s.windows.size(), 1);
}

/// The bound is one of M⁻¹V'': it says nothing where forces depend on velocities or the mass on the place.
TEST(Certificate, IsSampledWhereTheBoundDoesNotApply) {
  const Solution magnetic =
      solve(bounded(fixed_ends(systems::magnetic(), {0.3, -0.2}, {0.9, 0.5}, 1.5), 4), within(1e-9));
  EXPECT_EQ(magnetic.certificate, Certificate::sampled);
  const Problem swing = fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 0.8);
  EXPECT_EQ(solve(bounded(swing, 100), within(1e-9)).certificate, Certificate::sampled);
}

/// A bound below the curvature that the trajectory itself has.
TEST(Certificate, IsSampledWhereTheBoundIsWrong) {
  const Problem problem = fixed_ends(systems::oscillator(2), {0}, {1}, 5);
  const Solution s = solve(bounded(problem, 1), within(1e-9));
  EXPECT_EQ(s.certificate, Certificate::sampled);
  EXPECT_EQ(s.windows, solve(problem, within(1e-9)).windows);
}

}  // namespace
}  // namespace extremal::laws
