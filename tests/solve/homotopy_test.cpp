#include "machine/long_test.hpp"
#include "solve/homotopy/duration_homotopy.hpp"

#include <numbers>
#include <utility>

#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/homotopy/force_homotopy.hpp"
#include "solve/laws.hpp"

/// \file Families of extremals of all durations, and of all strengths of forces.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// The guess of a problem on equal elements of degree 8, as a solve would begin.
struct Family {
  const Problem& problem;
  Path path;
  Workspace w;
  const ElementTables* tables;

  explicit Family(const Problem& of) : problem(of) {
    w.levels.bind(problem.lagrangian);
    tables = &w.levels.at(8);
    const std::vector<double> mesh = uniform_mesh(8);
    w.iteration.reset(problem, *tables, 8);
    path.reset(*tables, mesh, problem.duration.value);
    start_path(problem, starting_ends(problem), *tables, path);
  }
};

Problem circle(double angle, double duration) {
  return guessed(fixed_ends(systems::kepler(), {1, 0}, {std::cos(angle), std::sin(angle)}, duration),
                 [angle](double tau) {
                   return Values{std::cos(angle * tau), std::sin(angle * tau)};
                 });
}

/// A circle of radius 1 is run through in its angle, whatever duration is wanted. (Short arcs are nearly
/// straight: many durations will do.)
TEST(NaturalDurations, OfAnArcOfACircle) {
  for (double angle : {4.0, 5.0, 5.8})
    for (double wanted : {0.5, 4.0, 20.0}) {
      const Problem problem = circle(angle, wanted);
      Family begun(problem);
      const std::vector<double> durations = natural_durations(problem, begun.path, begun.w, *begun.tables);
      ASSERT_FALSE(durations.empty());
      EXPECT_LE(std::abs(std::log2(durations.front() / angle)), 0.26) << angle << ", " << wanted;
    }
}

/// Along a straight line the distance from a motion grows with the duration: short ones are natural.
TEST(NaturalDurations, OfAStraightLine) {
  const Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 40);
  Family begun(problem);
  const std::vector<double> durations = natural_durations(problem, begun.path, begun.w, *begun.tables);
  ASSERT_FALSE(durations.empty());
  EXPECT_LT(durations.front(), 3);
  EXPECT_GT(durations.front(), 0.5);
}

/// From the circle with its own duration to a longer and to a shorter one: a Newton step then converges.
TEST(DurationHomotopy, LeadsToTheDurationWanted) {
  for (double wanted : {2.0, 9.0}) {
    const Problem problem = circle(4, wanted);
    Family begun(problem);
    begun.path.set_duration(4);
    ASSERT_TRUE(DurationHomotopy(problem, begun.path, begun.w, [] { return true; }).trace(*begun.tables));
    EXPECT_EQ(begun.path.duration(), wanted);
    begun.w.iteration.reset(problem, *begun.tables, 8);
    begun.w.iteration.set_scale(1);
    ASSERT_EQ(begun.w.iteration.full_step(begun.path, 1), StepResult::ok);
    EXPECT_EQ(begun.w.iteration.damping(), 1);
    EXPECT_LT(begun.w.iteration.undamped(), 0.1);
  }
}

/// Bratu's problem has no extremal longer than λT² = 3.5138: the family turns back, is followed past the
/// fold, and does not come to where there is none.
TEST(DurationHomotopy, TurnsAtAFold) {
  const auto bratu = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 - exp(q[0]); });
  const Problem problem = fixed_ends(bratu, {0}, {0}, 2);
  Family begun(problem);
  for (double& x : std::span(begun.path.x(0), 8 * 7)) x = 0.05;  // a path without extent has no scale
  begun.path.set_duration(0.5);
  double longest = 0;
  int steps = 0;
  const auto watch = [&] {
    longest = std::max(longest, begun.path.duration());
    return ++steps < 200;
  };
  EXPECT_FALSE(DurationHomotopy(problem, begun.path, begun.w, watch).trace(*begun.tables));
  EXPECT_GT(longest, std::sqrt(3.513830719) - 0.1);
  EXPECT_LT(begun.path.duration(), 1.5);
}

TEST(DurationHomotopy, StopsWhenToldTo) {
  const Problem problem = circle(4, 9);
  Family begun(problem);
  begun.path.set_duration(4);
  int steps = 0;
  EXPECT_FALSE(
      DurationHomotopy(problem, begun.path, begun.w, [&] { return ++steps < 5; }).trace(*begun.tables));
  EXPECT_EQ(steps, 5);
}

/// Of a chain of pendulums: linear between neighbours, bounded in each angle.
std::shared_ptr<const Lagrangian> pendulums(int n) {
  return trace(n, [n](auto q, auto v, auto) {
    auto sum = v[0] * v[0] / 2 + cos(q[0]);
    for (int i = 1; i < n; ++i)
      sum = sum + v[i] * v[i] / 2 + cos(q[i]) - 0.15 * (q[i] - q[i - 1]) * (q[i] - q[i - 1]);
    return sum;
  });
}

Problem chain_of_pendulums(int n) {
  Values start, end;
  for (int i = 1; i <= n; ++i) {
    start.push_back(1.5 * std::cos(2 * pi * i / n));
    end.push_back(0.5 * std::sin(2 * pi * i / n));
  }
  return fixed_ends(pendulums(n), start, end, 4);
}

/// Far from the guess bounded forces have no second derivatives: Q is linear forces alone.
TEST(ForceHomotopy, BeginsWithLinearForces) {
  const Problem problem = chain_of_pendulums(3);
  const auto weakened = WeakenedLagrangian::about(problem, 8);
  ASSERT_TRUE(weakened);
  weakened->set_part(0);
  Scratch scratch;
  const Values q = {0.3, -1, 2}, v = {0, 0, 0};
  const PointValues at = evaluate_at(*weakened, q, v, 0, Order::hessian, scratch);
  const double expected[] = {-0.3, 0.3, 0, 0.3, -0.6, 0.3, 0, 0.3, -0.3};
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(at.qq[k], expected[k], 0.01) << k;
  EXPECT_EQ(at.vv[0], 1);
}

/// Rows of L_λ are derivatives of its value.
TEST(ForceHomotopy, DerivativesAreThoseOfTheValue) {
  const auto weakened = WeakenedLagrangian::about(chain_of_pendulums(3), 1);
  ASSERT_TRUE(weakened);
  weakened->set_part(0.4);
  Scratch scratch;
  const Values v = {0.1, 0.2, -0.3};
  const auto values = [&](double x) {
    return evaluate_at(*weakened, Values{x, -1, 2}, v, 0, Order::hessian, scratch);
  };
  const double h = 1e-5;
  EXPECT_NEAR((values(0.3 + h).value - values(0.3 - h).value) / (2 * h), values(0.3).dq[0], 1e-8);
  for (int b = 0; b < 3; ++b)
    EXPECT_NEAR((values(0.3 + h).dq[b] - values(0.3 - h).dq[b]) / (2 * h), values(0.3).qq[b], 1e-8) << b;
}

/// The straight line is far from every extremal.
TEST(ForceHomotopy, FindsWhatOtherGuessesDoNot) {
  LONG_TEST();
  const Solution solution = solve(chain_of_pendulums(5), within(1e-10));
  ASSERT_TRUE(solution.converged()) << solution.message;
  for (const int n : {20, 60}) {
    const Solution more = solve(chain_of_pendulums(n), within(1e-8));
    EXPECT_TRUE(more.converged()) << n << ": " << more.message;
  }
}

}  // namespace
}  // namespace extremal::laws
