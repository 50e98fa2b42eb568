#include "solve/mesh/conservation.hpp"

#include "solve/laws.hpp"
#include "solve/refused.hpp"

/// \file Kinks between the points of elements, which the elements do not see and the energy does.

namespace extremal::laws {
namespace {

/// L = q'²/2 − |q| from −1 to 1/2: q'' = 1 until q = 0 at time t, then −1.
struct Kink {
  double duration, speed, passage;

  /// The speed v at the start has q(T) = (v + t)(T − t) − (T − t)²/2 with v t + t²/2 = 1.
  explicit Kink(double T) : duration(T) {
    double low = -1, high = 20;
    for (int k = 0; k < 200; ++k) {
      speed = (low + high) / 2;
      passage = std::sqrt(speed * speed + 2) - speed;
      (after(T) < 0.5 ? low : high) = speed;
    }
  }
  double after(double t) const { return (speed + passage) * (t - passage) - std::pow(t - passage, 2) / 2; }
  double at(double t) const { return t < passage ? -1 + speed * t + t * t / 2 : after(t); }
  Problem problem() const {
    // Not abs, at whose kinks elements end.
    return fixed_ends(
        trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 - sqrt(q[0] * q[0] + 1e-30); }), {-1},
        {0.5}, duration);
  }
  double error(const Trajectory& trajectory) const {
    double most = 0, q = 0, v = 0;
    for (int k = 0; k <= 1000; ++k) {
      const double t = duration * k / 1000;
      trajectory.at(t, {&q, 1}, {&v, 1});
      most = std::max(most, std::abs(q - at(t)));
    }
    return most;
  }
};

/// Or it is refused: where the kink falls in its element depends on the last digits.
TEST(Conservation, AKinkWithinAnElementShowsInTheEstimate) {
  for (const double duration : {1.0, 2.3}) {
    const Kink kink(duration);
    const Solution s = Solver().solve(kink.problem(), within(1e-4));
    if (!s.converged()) {
      EXPECT_NE(s.message.find("a kink on the path"), std::string::npos) << s.message;
      continue;
    }
    const double error = kink.error(s.trajectory);
    EXPECT_GT(error, 1e-6);
    EXPECT_GE(s.error_estimate, 0.1 * error) << duration;
  }
}

/// A spring pendulum that passes its anchor, where the force turns round at once.
TEST(Conservation, APassageThatIsNotResolvedIsRefused) {
  const auto spring = trace(2, [](auto q, auto v, auto) {
    const auto stretch = sqrt(q[0] * q[0] + q[1] * q[1]) - 0.7;
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 - 5.0 * stretch * stretch;
  });
  const Problem problem = with_ends(spring, 0.1, [](BoundaryRelation& relation) {
    relation.fix(1, false, -0.4);
    relation.fix(1, true, 0.25);
  });
  const Solution first = first_judged(problem, within(1e-9));
  EXPECT_EQ(first.status, Status::not_converged);
  EXPECT_NE(first.message.find("the energy drifts"), std::string::npos) << first.message;
  const Solution other = Solver().solve(problem, within(1e-9));
  if (other.converged()) expect_verified(problem, other, 1e-9);
}

TEST(Conservation, WhatTheToleranceExplains) {
  const Trajectory path{1, 2, {0, 0.5, 1}, {0, 0.25, 0.5, 0.5, 0.75, 1}};
  Survey survey{.q = {1}, .v = {1}, .p = {2}, .speed = 3, .momentum = 4, .force = 5, .terms = 1};
  // 10 (10 · 3 · 2 + 5 · 1) tolerances.
  survey.energy_drift = 0.99 * 650e-6;
  EXPECT_TRUE(conserves_energy(survey, path, 1e-6));
  survey.energy_drift = 1.01 * 650e-6;
  EXPECT_FALSE(conserves_energy(survey, path, 1e-6));
  // A smooth error of 1e-6 makes 10 (4 · 2 · 3/0.5 + 5) times that; more is a kink's, 4/0.5 + 5 by its own.
  survey.energy_drift = 0.99 * 530e-6;
  EXPECT_EQ(error_behind_drift(survey, path, 1e-6), 1e-6);
  survey.energy_drift = 1.01 * 530e-6;
  EXPECT_DOUBLE_EQ(error_behind_drift(survey, path, 1e-6), survey.energy_drift / 13);
}

}  // namespace
}  // namespace extremal::laws
