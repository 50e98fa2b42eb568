#include "solution/observe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "action/rule.hpp"
#include "system/tape.hpp"

namespace extremal {
namespace {

/// Elements of length T/elements that carry f(t, q) at their Lobatto nodes.
template <class Function>
Trajectory sampled(int coordinates, int degree, int elements, double duration, Function f) {
  Trajectory trajectory{coordinates, degree, {}, {}};
  for (int k = 0; k <= elements; ++k) trajectory.times.push_back(duration * k / elements);
  for (int k = 0; k < elements; ++k)
    for (const double node : lobatto_rule(degree + 1).nodes) {
      double q[2];
      f(trajectory.times[k] + (trajectory.times[k + 1] - trajectory.times[k]) * node, q);
      trajectory.nodes.insert(trajectory.nodes.end(), q, q + coordinates);
    }
  return trajectory;
}

/// Charge in a uniform field B = 2 along z, frequency 2: p = v + (−y, x).
std::shared_ptr<const Lagrangian> charge() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 + (q[0] * v[1] - q[1] * v[0]);
  });
}

void circle(double t, double* q) {
  q[0] = std::cos(2 * t);
  q[1] = -std::sin(2 * t);
}

TEST(Observe, ChargeOnItsCircle) {
  const Survey found = survey(*charge(), sampled(2, 12, 44, 7.0, circle));
  EXPECT_NEAR(found.energy, 2, 1e-13);
  EXPECT_LE(found.energy_drift, 1e-12);
  EXPECT_NEAR(found.q[0], 2, 1e-3);
  EXPECT_NEAR(found.v[1], 4, 1e-3);
  // v = −2 (sin 2t, cos 2t) and (−y, x) = (sin 2t, cos 2t).
  EXPECT_NEAR(found.p[0], 2, 1e-3);
  EXPECT_NEAR(found.p[1], 2, 1e-3);
  // |sin| + |cos| is √2 at most; terms of p: v and (−y, x), three times that; ∂L/∂q = (v1, −v0); terms of
  // p·v: 6; L = 0.
  EXPECT_NEAR(found.speed, 2 * std::numbers::sqrt2, 1e-3);
  EXPECT_NEAR(found.momentum, 3 * std::numbers::sqrt2, 1e-3);
  EXPECT_NEAR(found.force, 2 * std::numbers::sqrt2, 1e-3);
  EXPECT_NEAR(found.terms, 6, 1e-11);
}

TEST(Observe, DriftIsTheLargestDeparture) {
  // Free fall at the wrong acceleration: q = t², L = v²/2, E = 2t².
  const auto free = trace(1, [](auto, auto v, auto) { return v[0] * v[0] / 2.0; });
  const Survey found = survey(*free, sampled(1, 2, 5, 3.0, [](double t, double* q) { q[0] = t * t; }));
  EXPECT_NEAR(found.energy, 0, 1e-15);
  EXPECT_NEAR(found.energy_drift, 18, 1e-12);
  EXPECT_NEAR(found.q[0], 9, 1e-13);
  EXPECT_NEAR(found.p[0], 6, 1e-12);
}

TEST(Observe, ConfigurationDependentMass) {
  // L = e^q v²/2 has e^{q/2} = 1 + t/2 for e^{q} v² = 1: E = 1/2 and p = e^{q/2}.
  const auto system = trace(1, [](auto q, auto v, auto) { return exp(q[0]) * v[0] * v[0] / 2.0; });
  const Survey found =
      survey(*system, sampled(1, 14, 4, 2.0, [](double t, double* q) { q[0] = 2 * std::log1p(t / 2); }));
  EXPECT_NEAR(found.energy, 0.5, 1e-12);
  EXPECT_LE(found.energy_drift, 1e-12);
  EXPECT_NEAR(found.p[0], 1, 1e-12);
}

TEST(Observe, EnergyOfASolution) {
  Solution solution;
  solution.trajectory = sampled(2, 12, 11, 7.0, circle);
  EXPECT_TRUE(observe_energy(*charge(), solution));
  ASSERT_TRUE(solution.energy && solution.energy_drift);
  EXPECT_NEAR(*solution.energy, 2, 1e-13);
  const auto driven =
      trace(2, [](auto q, auto v, auto t) { return (v[0] * v[0] + v[1] * v[1]) / 2.0 + q[0] * cos(t); });
  EXPECT_FALSE(observe_energy(*driven, solution));
  EXPECT_FALSE(solution.energy || solution.energy_drift);
}

TEST(Observe, EnergyThatIsNotFiniteIsAbsent) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  Solution solution;
  solution.trajectory = sampled(1, 1, 2, 2.0, [](double t, double* q) { q[0] = t - 1; });
  observe_energy(*central, solution);
  EXPECT_FALSE(solution.energy || solution.energy_drift);
}

TEST(Observe, CoordinatesMustAgree) {
  const auto free = trace(1, [](auto, auto v, auto) { return v[0] * v[0]; });
  EXPECT_THROW(survey(*free, sampled(2, 2, 1, 1.0, circle)), std::invalid_argument);
}

}  // namespace
}  // namespace extremal
