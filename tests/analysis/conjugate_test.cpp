#include <numbers>

#include "analysis/independent.hpp"

/// \file Times conjugate to the start, in closed form and against the Jacobi equation integrated forward.

namespace extremal::laws {
namespace {

using std::numbers::pi;

std::shared_ptr<const Lagrangian> oscillators(const Values& omega) {
  return trace(static_cast<int>(omega.size()), [&](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (std::size_t i = 0; i < omega.size(); ++i)
      l += (v[i] * v[i] - omega[i] * omega[i] * q[i] * q[i]) / 2 + 0.3 * q[i];
    return l;
  });
}

void expect_times(const Solution& s, const Values& truth, double allowed) {
  ASSERT_EQ(s.conjugate_times.size(), truth.size());
  EXPECT_LT(largest_difference(s.conjugate_times, truth), allowed);
}

/// kπ/ω, as many as the index with fixed ends.
TEST(ConjugateTimes, OfOscillators) {
  for (const Values& omega :
       {Values{0.31}, Values{1.0}, Values{2.9}, Values{0.7, 1.3, 2.1}, Values{1.0, 1.0}})
    for (double T : {0.5, 3.3, 10.3, 24.4, 100.0}) {
      Values truth;
      for (double w : omega)
        for (int k = 1; k * pi / w < T; ++k) truth.push_back(k * pi / w);
      std::sort(truth.begin(), truth.end());
      const Values start(omega.size(), 0.0), end(omega.size(), 1.0);
      const auto lagrangian = oscillators(omega);
      const Solution s = solve(fixed_ends(lagrangian, start, end, T), within(1e-9));
      expect_times(s, truth, 1e-13 * T);
      EXPECT_EQ(s.morse_index, truth.size());
      EXPECT_EQ(s.certificate, Certificate::sampled);
    }
}

/// A conjugate time on a node between elements: T = 8π/3 with eight elements, T = 5π/2 with more.
TEST(ConjugateTimes, OnANode) {
  for (double T : {8 * pi / 3, 5 * pi / 2, 8 * pi / 5}) {
    for (const Values& omega : {Values{1.0}, Values{1.0, 1.0, 0.3}}) {
      const Solution s =
          solve(fixed_ends(oscillators(omega), Values(omega.size(), 0.0), Values(omega.size(), 1.0), T),
                within(1e-9));
      Values truth;
      for (double w : omega)
        for (int k = 1; k * pi / w < T; ++k) truth.push_back(k * pi / w);
      std::sort(truth.begin(), truth.end());
      expect_times(s, truth, 1e-12);
      EXPECT_EQ(s.morse_index, truth.size());
    }
  }
}

/// Hyperbolic directions beside an elliptic one, e^(40·6) apart, and a coordinate with another unit.
TEST(ConjugateTimes, BesideUnstableDirections) {
  const auto lagrangian = trace(3, [](auto q, auto v, auto) {
    const auto a = q[0] + 0.3 * q[1], b = 1e6 * q[2] - 0.2 * q[0];
    return ((v[0] + 0.3 * v[1]) * (v[0] + 0.3 * v[1]) + v[1] * v[1] +
            (1e6 * v[2] - 0.2 * v[0]) * (1e6 * v[2] - 0.2 * v[0])) /
               2 -
           a * a / 2 + 18 * q[1] * q[1] + 0.5 * b * b;
  });
  const Solution s = solve(fixed_ends(lagrangian, {0, 0, 0}, {1, 0.5, 1e-6}, 40), within(1e-9));
  Values truth;
  for (int k = 1; k * pi < 40; ++k) truth.push_back(k * pi);
  expect_times(s, truth, 1e-9);
  EXPECT_EQ(s.morse_index, 12);
}

/// Charge in the plane, field 1: the cyclotron motion closes after 2π/B, where all fields that vanish at the
/// start vanish again: multiplicity 2.
TEST(ConjugateTimes, OfAMagneticField) {
  for (double field : {1.0, 2.3}) {
    const auto lagrangian = trace(2, [=](auto q, auto v, auto) {
      return (v[0] * v[0] + v[1] * v[1]) / 2 + field * (q[0] * v[1] - q[1] * v[0]) / 2;
    });
    const double T = 15;
    const Solution s = solve(fixed_ends(lagrangian, {0, 0}, {1, 0.5}, T), within(1e-9));
    Values truth;
    for (int k = 1; 2 * k * pi / field < T; ++k) truth.insert(truth.end(), 2, 2 * k * pi / field);
    // A double eigenvalue moves by the root of what moves it.
    expect_times(s, truth, 1e-6);
    EXPECT_EQ(s.morse_index, truth.size());
  }
}

std::shared_ptr<const Lagrangian> ellipsoid(double a, double b, double c) {
  return trace(2, [=](auto q, auto v, auto) {
    const auto x = -a * (sin(q[0]) * cos(q[1]) * v[0] + cos(q[0]) * sin(q[1]) * v[1]);
    const auto y = b * (cos(q[0]) * cos(q[1]) * v[1] - sin(q[0]) * sin(q[1]) * v[0]);
    const auto z = c * cos(q[0]) * v[0];
    return (x * x + y * y + z * z) / 2;
  });
}

/// A great circle of length 3.5 in time 1: conjugate after π.
TEST(ConjugateTimes, OfGreatCircles) {
  const double length = 3.5, tilt = 0.4;
  const auto point = [=](double tau) {
    const double x = std::cos(length * tau), y = std::sin(length * tau);
    return Values{std::asin(std::sin(tilt) * y), std::atan2(std::cos(tilt) * y, x) + (y < 0 ? 2 * pi : 0)};
  };
  const Problem problem = guessed(fixed_ends(ellipsoid(1, 1, 1), point(0), point(1), 1), point);
  const Solution s = solve(problem, within(1e-11));
  expect_times(s, {pi / length}, 1e-11);
  EXPECT_EQ(s.morse_index, 1);
  EXPECT_FALSE(s.minimizing);
  ASSERT_EQ(s.windows.size(), 2);
  EXPECT_LT(s.windows[0][1], pi / length);
  EXPECT_GT(s.windows[0][1], (1 - 2e-6) * pi / length);
}

/// Solutions of systems without a closed form, a guess from a rough curve.
struct Motion {
  const char* name;
  Problem problem;
  int steps;
};

std::vector<Motion> motions() {
  std::vector<Motion> list;
  list.push_back({"ellipsoid",
                  guessed(fixed_ends(ellipsoid(1.3, 1.0, 0.8), {0.3, 0.1}, {-0.2, 5.0}, 1),
                          [](double tau) {
                            return Values{0.3 - 0.5 * tau, 0.1 + 4.9 * tau};
                          }),
                  40});
  list.push_back({"pendulum",
                  guessed(fixed_ends(systems::pendulum(), {0.3}, {0.5}, 20),
                          [](double tau) { return Values{0.8 * std::sin(0.38 + 19.2 * tau)}; }),
                  60});
  list.push_back({"double pendulum",
                  guessed(fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 2),
                          [](double tau) {
                            return Values{0.5 - 0.7 * tau, 0.5 - 0.8 * tau};
                          }),
                  200});
  list.push_back(
      {"varying magnetic field", fixed_ends(systems::magnetic(), {0.3, -0.2}, {0.2, 0.5}, 9), 200});
  list.push_back({"driven", fixed_ends(systems::driven(), {0}, {1}, 9), 60});
  list.push_back(
      {"rotating frame",
       guessed(fixed_ends(systems::restricted_three_body(), {0.4, 0.5, 0.1}, {-0.3, -0.6, 0.05}, 3),
               [](double tau) {
                 return Values{0.65 * std::cos(0.9 + 3.3 * tau), 0.65 * std::sin(0.9 + 3.3 * tau), 0.05};
               }),
       200});
  return list;
}

TEST(ConjugateTimes, AgreeWithTheJacobiEquation) {
  int found = 0;
  for (const Motion& m : motions()) {
    const Lagrangian& lagrangian = *m.problem.lagrangian;
    const Solution s = solve(m.problem, within(1e-11));
    const Values truth = integrated_conjugate_times(lagrangian, s, m.steps);
    found += static_cast<int>(truth.size());
    EXPECT_EQ(s.morse_index, truth.size()) << m.name;
    ASSERT_EQ(s.conjugate_times.size(), truth.size()) << m.name;
    EXPECT_LT(largest_difference(s.conjugate_times, truth), 1e-8 * s.duration()) << m.name;
  }
  EXPECT_GE(found, 16);
}

}  // namespace
}  // namespace extremal::laws
