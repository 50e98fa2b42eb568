#include "solve/homotopy/duration_homotopy.hpp"

#include <numbers>

#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"

/// \file Families of extremals of all durations.

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

}  // namespace
}  // namespace extremal::laws
