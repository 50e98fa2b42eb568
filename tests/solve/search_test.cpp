#include <numbers>
#include <random>

#include "machine/long_test.hpp"
#include "rivals/verify.hpp"
#include "solve/adapt/refinement.hpp"
#include "solve/mesh/mesh.hpp"
#include "solve/motions.hpp"
#include "study/study.hpp"

/// \file Extremals from poor guesses: found, verified by integration, the same each time, at bounded cost.

namespace extremal::laws {
namespace {

using std::numbers::pi;

void expect_found(const Problem& problem, double tolerance = 1e-9) {
  Solver solver;
  const Solution solution = solver.solve(problem, counted(within(tolerance)));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const Verification verification = verify(problem, solution.trajectory, {.tolerance = tolerance});
  EXPECT_TRUE(verification.verified) << solution.strategy << ": " << verification.message;
}

TEST(Search, PendulumOverManySwings) {
  for (int k = 0; k < 8; ++k)
    expect_found(ends_of_motion(systems::pendulum(), {std::sin(3.0 * k)}, {1.5 * std::cos(5.0 * k)}, 40));
}

TEST(Search, PendulumThatTurnsOver) {
  for (double speed : {2.05, 2.2, 2.6, 2.9})
    expect_found(ends_of_motion(systems::pendulum(), {-0.5}, {speed}, 40));
}

TEST(Search, HenonHeiles) {
  for (int k = 0; k < 6; ++k)
    expect_found(ends_of_motion(systems::henon_heiles(), {0.2 * std::sin(2.0 * k), 0.2 * std::cos(3.0 * k)},
                                {0.4 * std::cos(5.0 * k), 0.25 * std::sin(7.0 * k)}, 20));
}

TEST(Search, DoublePendulum) {
  for (int k = 0; k < 4; ++k)
    expect_found(ends_of_motion(systems::double_pendulum(), {0, 0},
                                {3 * std::sin(1.0 + k), 3 * std::cos(2.0 * k)}, 3));
}

/// From a straight line that passes the centre at a hundredth of its length.
TEST(Search, KeplerArcFromALineByTheCentre) {
  for (double angle : {3.12, 3.16})
    expect_found(fixed_ends(systems::kepler(), {1, 0}, {1.2 * std::cos(angle), 1.2 * std::sin(angle)}, 3));
}

/// The angle that a trajectory runs through about the origin.
double angle_run(const Trajectory& trajectory) {
  double sum = 0, before = 0;
  for (int i = 0; i <= 2000; ++i) {
    const Values q = at(trajectory, trajectory.duration() * i / 2000).q;
    const double angle = std::atan2(q[1], q[0]);
    if (i > 0) sum += std::remainder(angle - before, 2 * pi);
    before = angle;
  }
  return sum;
}

struct Arc {
  double eccentricity, start, angle;  ///< true anomaly at the start, angle run through; degrees
};

/// Guessed by a circular arc, uniform in t: ellipses through either apsis, near and far from the circle.
TEST(Search, KeplerArcOnTheSideOfTheGuess) {
  for (const Arc& arc : {Arc{0.3, 10, 80}, Arc{0.6, 100, 150}, Arc{0.8, -60, 200}, Arc{0.5, 120, 220},
                         Arc{0.7, 45, 260}, Arc{0.2, 200, 300}, Arc{0.75, 25, 310}, Arc{0.4, 90, 335}}) {
    const double e = arc.eccentricity, first = arc.start * pi / 180, angle = arc.angle * pi / 180;
    const auto radius = [e](double f) { return (1 - e * e) / (1 + e * std::cos(f)); };
    const auto mean_anomaly = [e](double f) {
      const double turns = std::round(f / (2 * pi));
      const double x = 2 * std::atan(std::sqrt((1 - e) / (1 + e)) * std::tan((f - 2 * pi * turns) / 2));
      return x - e * std::sin(x) + 2 * pi * turns;
    };
    const double r0 = radius(first), r1 = radius(first + angle);
    const Problem problem =
        guessed(fixed_ends(systems::kepler(), {r0, 0}, {r1 * std::cos(angle), r1 * std::sin(angle)},
                           mean_anomaly(first + angle) - mean_anomaly(first)),
                [&](double tau) {
                  const double r = r0 + tau * (r1 - r0);
                  return Values{r * std::cos(tau * angle), r * std::sin(tau * angle)};
                });
    const Solution solution = solve(problem, within(1e-9));
    EXPECT_NEAR(angle_run(solution.trajectory), angle, 1e-6)
        << "e = " << e << ", " << arc.angle << " degrees, by " << solution.strategy;
  }
}

/// Both extremals of Bratu's problem have their maximum θ in the middle: θ = 2 ln cosh(√(λ e^θ / 8)).
TEST(Search, BratuNearItsFold) {
  const Problem problem = fixed_ends(systems::bratu(3.5), {0}, {0}, 1);
  const double peak = at(solve(problem, within(1e-10)).trajectory, 0.5).q[0];
  EXPECT_NEAR(peak, 2 * std::log(std::cosh(std::sqrt(3.5 * std::exp(peak) / 8))), 1e-8);
}

/// A stiff spring that swings ten times and more: no line comes near a motion, and all motions are led to the
/// end on one curve.
TEST(Search, MotionsAreLedToTheEnd) {
  const auto spring = [](double m, double alpha, double beta) {
    return trace(1, [=](auto q, auto v, auto) {
      return m * v[0] * v[0] / 2.0 - alpha * q[0] * q[0] / 2.0 - beta * q[0] * q[0] * q[0] * q[0] / 4.0;
    });
  };
  const Problem fixed = fixed_ends(spring(0.295, 1.162, 1.044), {-1.987}, {-0.697}, 17.04);
  Problem free = fixed_ends(spring(0.205, 0.168, 0.651), {-1.44}, {-1.15}, 35.49);
  free.duration = {.value = 35.49, .free = true, .energy = 0.8805, .where = {}};
  for (const Problem& problem : {fixed, make_problem(free)}) {
    const Solution s = solve(problem, within(1e-8));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_LT(*s.energy_drift, 1e-5);
    EXPECT_NEAR(at(s.trajectory, s.duration()).q[0], problem.boundary.value.back(), 1e-12);
    if (problem.duration.free) {
      EXPECT_NEAR(*s.energy, 0.8805, 1e-7);
    }
  }
}

TEST(Search, SaysWhatWasTriedWhereNothingIsFound) {
  SolveOptions options = within(1e-9);
  options.max_iterations = 600;
  Solver solver;
  const Solution solution = solver.solve(fixed_ends(systems::bratu(4), {0}, {0}, 1), counted(options));
  EXPECT_EQ(solution.status, Status::iteration_limit);
  // A part is kept for the last way, which may need less.
  EXPECT_LE(solution.iterations, 600);
  EXPECT_GE(solution.iterations, 450);
  const std::string steps = std::to_string(solution.iterations) + " Newton steps from the guess (";
  for (const std::string& words : {steps, std::string("smooth noise"), std::string("try a better guess")})
    EXPECT_NE(solution.message.find(words), std::string::npos) << solution.message;
  EXPECT_TRUE(solution.trajectory.nodes.empty());
}

/// Where the duration is free there are no others to go through.
TEST(Search, SaysNothingOfWhatWasNotTried) {
  SolveOptions options = within(1e-9);
  options.max_iterations = 300;
  Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 1);
  problem.duration = {.value = 1, .free = true, .energy = -2, .where = {}};
  const Solution solution = Solver().solve(make_problem(problem), options);
  EXPECT_FALSE(solution.converged());
  EXPECT_EQ(solution.message.find("other durations"), std::string::npos) << solution.message;
}

TEST(Search, IsTheSameEachTime) {
  Solver used;
  for (const Problem& problem : {ends_of_motion(systems::henon_heiles(), {0.1, 0.2}, {0.4, 0.1}, 40),
                                 ends_of_motion(systems::pendulum(), {0.3}, {1.9}, 60)}) {
    const Solution first = solve(problem, within(1e-9)), again = solve(used, problem, within(1e-9));
    EXPECT_EQ(first.trajectory.nodes, again.trajectory.nodes);
    EXPECT_EQ(first.strategy, again.strategy);
    EXPECT_EQ(first.iterations, again.iterations);
  }
}

/// V'' <= 0: the action with fixed ends is convex and has one extremal, from whatever guess.
TEST(Search, ConvexActionFromAnyGuess) {
  LONG_TEST();
  const std::shared_ptr<const Lagrangian> convex[] = {
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + q[0] * q[0] * q[0] * q[0]; }),
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + exp(5.0 * q[0]); }),
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + sqrt(1 + 900.0 * q[0] * q[0]); }),
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + 20.0 * log(exp(8.0 * q[0]) + 1.0); }),
  };
  std::minstd_rand random(7);
  const auto draw = [&] { return 2.0 * random() / std::minstd_rand::max() - 1; };
  for (const auto& lagrangian : convex) {
    for (double duration : {0.5, 3.0}) {
      const Problem problem = fixed_ends(lagrangian, {1}, {-0.5}, duration);
      const Solution from_line = solve(problem, within(1e-10));
      for (double size : {1.0, 20.0, 60.0}) {
        const double c[] = {draw(), draw(), draw()};
        const Problem guess = guessed(problem, [&](double tau) {
          double q = 1 - 1.5 * tau;
          for (int m = 1; m <= 3; ++m) q += size * c[m - 1] * std::sin(m * pi * tau);
          return Values{q};
        });
        Solver solver;
        const Solution solution = solver.solve(guess, counted(within(1e-10)));
        ASSERT_TRUE(solution.converged()) << duration << ", " << size << ": " << solution.message;
        EXPECT_LT(sup_distance(solution.trajectory, from_line.trajectory), 1e-9);
      }
    }
  }
}

/// Guesses whose first step is dearer than what is left must not be tried for ever.
TEST(Search, PathsThatAreOnlyFilledCountAsEffort) {
  const Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 1);
  SolveOptions options;
  Workspace workspace;
  workspace.levels.bind(problem.lagrangian);
  Outcome outcome;
  extremal::Refinement refinement(problem, options, workspace, outcome);
  refinement.open(uniform_mesh(1000));
  refinement.allow(1000);
  int filled = 0;
  for (const int most = 100000; !refinement.exhausted() && filled < most; ++filled)
    refinement.open(uniform_mesh(1000));
  EXPECT_GT(filled, 1000);
  EXPECT_LT(filled, 100000);
  EXPECT_EQ(outcome.iterations, 0);
}

/// The softest direction left out, coarse elements lead finer ones to where no step helps; all taken, not.
TEST(Search, CoarseElementsHaveTheirTurn) {
  const Study study =
      load(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/found/ellipsoid-geodesic-coarse.toml");
  const Solution s = run(study);
  EXPECT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.strategy, "newton from the guess");
}

}  // namespace
}  // namespace extremal::laws
