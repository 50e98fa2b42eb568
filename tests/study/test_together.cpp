#include <fmt/format.h>

#include <cmath>

#include "scenes.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"
#include "study/fitting.hpp"

/// \file Waypoints, conditions, unknowns and integrals together with closed paths, forces and inequalities.

using namespace extremal;
using namespace extremal::test;

namespace {

using Together = Scenes;

class FitsTogether : public Scenes {
 protected:
  void SetUp() override {
    Scenes::SetUp();
    if (!can_fit()) GTEST_SKIP() << "this build has no Ceres";
  }

  /// The fit of a scene, which ends in [fit], to x(t) at times between 0 and T.
  template <class Path>
  FitResult fitted(const std::string& scene, double duration, const Path& x) {
    std::string data = "t,x\n";
    for (int k = 1; k < 20; ++k) {
      const double t = duration * k / 20;
      data += fmt::format("{},{:.17g}\n", t, x(t));
    }
    write("data.csv", data);
    return run_fit(study(scene + "data = \"data.csv\"\n"));
  }
};

std::string line(const std::string& lagrangian, const std::string& boundary) {
  return fmt::format("[system]\ncoordinates = [\"x\"]\nlagrangian = \"{}\"\n[boundary]\n{}", lagrangian,
                     boundary);
}

double coordinate_at(const Solution& solution, double t, std::size_t a = 0) {
  std::vector<double> q(solution.trajectory.coordinates), v(q);
  solution.trajectory.at(t, q, v);
  return q[a];
}

double impulse(const Solution& solution, std::size_t waypoint, std::size_t k = 0) {
  return solution.extension->waypoints.at(waypoint).impulse.at(k).second;
}

/// The zero of an increasing or decreasing function between two points.
template <class Function>
double zero(double a, double b, const Function& f) {
  const bool rises = f(b) > f(a);
  for (int k = 0; k < 200; ++k) {
    const double middle = (a + b) / 2;
    ((f(middle) > 0) == rises ? b : a) = middle;
  }
  return (a + b) / 2;
}

}  // namespace

/// x = A cos ω(t − t₁ − T/2) with A cos ωT/2 = x₁: the oscillator is pushed once a period.
TEST_F(Together, APushOncePerPeriodKeepsAnOscillatorClosed) {
  const double w = 0.8, T = 3, x1 = 0.7;
  const Solution solution =
      run(study(line("x'^2/2 - 0.32*x^2", "periodic = true\nduration = 3.0\n") +
                "[[waypoints]]\nat = 1.0\nx = 0.7\n[guess]\nx = \"0.5*cos(2*pi*t/T)\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(impulse(solution, 0), 2 * x1 * w * std::tan(w * T / 2), 1e-8);
  EXPECT_NEAR(coordinate_at(solution, 1 + T / 2), x1 / std::cos(w * T / 2), 1e-9);
  EXPECT_NEAR(coordinate_at(solution, 0), coordinate_at(solution, T), 1e-12);
  EXPECT_EQ(solution.morse_index, 0);  // ωT is less than π
  EXPECT_EQ(solution.nullity, 0);
}

/// Between two walls a free particle takes equal times there and back; where on the path time begins is open.
TEST_F(Together, FreeTimesOfWaypointsShiftWithAClosedPath) {
  const Solution solution =
      run(study(line("x'^2/2", "periodic = true\nduration = 3.0\n") +
                "[[waypoints]]\nat = \"free\"\nx = 1\n[[waypoints]]\nat = \"free\"\nx = 0\n"
                "[guess]\nx = \"0.5 - 0.5*cos(2*pi*t/T + 0.3)\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const auto& waypoints = solution.extension->waypoints;
  EXPECT_NEAR(std::abs(waypoints[1].time - waypoints[0].time), 1.5, 1e-9);
  EXPECT_NEAR(impulse(solution, 0), -4.0 / 3, 1e-9);
  EXPECT_NEAR(impulse(solution, 1), 4.0 / 3, 1e-9);
  EXPECT_EQ(solution.morse_index, 0);
  EXPECT_EQ(solution.nullity, 1);
}

/// x'' = −c x' on both legs.
TEST_F(Together, WaypointsOfADampedParticle) {
  const double c = 0.9, t1 = 0.4, rest = 0.6, x1 = 0.7;
  const std::string scene =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\nforce = { x = \"-0.9*x'\" }\n[boundary]\n"
      "start = { x = 0 }\nend = { x = 1 }\nduration = 1\n[[waypoints]]\n";
  const Solution solution = run(study(scene + "at = 0.4\nx = 0.7\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double before = x1 * c * std::exp(-c * t1) / (1 - std::exp(-c * t1)),
               after = (1 - x1) * c / (1 - std::exp(-c * rest));
  EXPECT_NEAR(impulse(solution, 0), after - before, 1e-9);
  EXPECT_NEAR(solution.momentum_end[0], after * std::exp(-c * rest), 1e-9);
  EXPECT_EQ(solution.extension->waypoints[0].impulse.size(), 1);
  EXPECT_FALSE(solution.morse_index);
  ASSERT_TRUE(solution.work);
  EXPECT_NEAR(*solution.work,
              (before * before - std::pow(before * std::exp(c * t1), 2)) / 2 +
                  (std::pow(after * std::exp(-c * rest), 2) - after * after) / 2,
              1e-8);
  EXPECT_EQ(message(scene + "at = \"free\"\nx = 0.7\n"),
            "scene.toml:10:6: with forces the time of a waypoint must be given; write a number");
}

/// With drag and weight to a circle: the velocity at the end is normal to it.
TEST_F(Together, NonlinearEndsOfADampedParticle) {
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
                "force = { x = \"-0.5*x'\", y = \"-0.5*y'\" }\n[boundary]\n"
                "conditions = [\"x(0) = 0.3\", \"y(0) = 0.4\", \"x(T)^2 + y(T)^2 = 4\"]\nduration = 2\n"
                "[guess]\nx = \"0.3 + 0.5*t\"\ny = \"0.4 + 0.5*t\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double c = 0.5, T = 2, part = (1 - std::exp(-c * T)) / c;
  const double x = coordinate_at(solution, T, 0), y = coordinate_at(solution, T, 1);
  const double vx = solution.momentum_end[0], vy = solution.momentum_end[1];
  EXPECT_NEAR(x * x + y * y, 4, 1e-9);
  EXPECT_NEAR(vx * y - vy * x, 0, 1e-8);
  EXPECT_NEAR(x, 0.3 + solution.momentum_start[0] * part, 1e-8);
  EXPECT_NEAR(y, 0.4 + solution.momentum_start[1] * part - (T - part) / c, 1e-8);
}

/// A particle with momentum 1 comes to y = 0 from y = −0.6 in unit time: (1 − e^{−c})/c = 0.6.
TEST_F(Together, AnUnknownOfTheForce) {
  const Solution solution =
      run(study("[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2\"\nforce = { y = \"-c*y'\" }\n"
                "[boundary]\nstart = { p_y = 1 }\nend = { y = 0 }\nduration = 1\nunknowns = { c = 0.5 }\n"
                "where = [\"y(0) = -0.6\"]\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double c = zero(0.1, 3, [](double x) { return (1 - std::exp(-x)) / x - 0.6; });
  EXPECT_NEAR(solution.extension->unknowns[0].second, c, 1e-9);
  ASSERT_TRUE(solution.work);
  EXPECT_NEAR(*solution.work, (std::exp(-2 * c) - 1) / 2, 1e-8);
}

/// A straight leg to the waypoint, then round the disc.
TEST_F(UnderInequalities, AWaypointBesideADisc) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n"
      "[path]\nconstraints = [\"x^2 + y^2 >= 1\"]\n[boundary]\nstart = { x = -2, y = 0 }\n"
      "end = { x = 2, y = 0 }\nduration = 1\n[[waypoints]]\nat = 0.3\n";
  const Solution solution = run(study(scene + "x = -1.5\ny = 1.5\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double square = 2.5, pi = std::acos(-1.0), r = 1.5 * std::sqrt(2.0);
  const double round = std::sqrt(r * r - 1) + std::sqrt(3.0) + 3 * pi / 4 - std::acos(1 / r) - pi / 3;
  EXPECT_NEAR(solution.action, square / 0.6 + round * round / 1.4, 1e-8);
  ASSERT_EQ(solution.contacts->contacts.size(), 1);
  EXPECT_NEAR(solution.contacts->contacts[0].from, 0.3 + std::sqrt(r * r - 1) / round * 0.7, 1e-7);
  // From the waypoint at −45° the tangent is steeper by asin 1/r.
  const double angle = -pi / 4 + std::asin(1 / r);
  EXPECT_NEAR(impulse(solution, 0, 0), round / 0.7 * std::cos(angle) - 0.5 / 0.3, 1e-7);
  EXPECT_NEAR(impulse(solution, 0, 1), round / 0.7 * std::sin(angle) - 1.5 / 0.3, 1e-7);
  EXPECT_TRUE(solution.minimizing);
  EXPECT_EQ(
      message(scene + "x = 0.5\ny = 0.5\n"),
      "scene.toml:10:1: the waypoint does not keep the inequality 'x^2 + y^2 >= 1': it is missed by 0.5 "
      "there; give values that keep it");
}

/// y'' = ν up to the ceiling at h: of area A it is reached at a = 3 (h − A)/(2h), ν = −2h/a².
TEST_F(UnderInequalities, AnAreaUnderACeiling) {
  const Solution solution = run(
      study("[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2\"\n[path]\nconstraints = [\"y <= 1\"]\n"
            "[boundary]\nstart = { y = 0 }\nend = { y = 0 }\nduration = 1\nintegrals = [\"y = 0.8\"]\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double a = 0.3;
  EXPECT_NEAR(solution.extension->integral_multipliers[0], -2 / (a * a), 1e-7);
  EXPECT_NEAR(solution.action, 4 / (3 * a), 1e-8);
  ASSERT_EQ(solution.contacts->contacts.size(), 1);
  EXPECT_NEAR(solution.contacts->contacts[0].from, a, 1e-8);
  EXPECT_NEAR(solution.contacts->contacts[0].to, 1 - a, 1e-8);
  std::vector<double> q(1), v(1);
  solution.trajectory.at(0.5, q, v);
  EXPECT_NEAR(solution.contacts->forces(q, v, 0.5)[0], 2 / (a * a), 1e-6);
  EXPECT_TRUE(solution.minimizing);
}

/// A chain of length 2.95 from height 1 to height 3 over unit width lies on a floor: two catenaries, of
/// parameter a each, that begin there.
TEST_F(UnderInequalities, AChainOnAFloor) {
  const double floor = 0.8;
  const Solution solution =
      run(study("[system]\ncoordinates = [\"y\"]\nlagrangian = \"y*sqrt(1 + y'^2)\"\n[path]\n"
                "constraints = [\"y >= 0.8\"]\n[boundary]\nstart = { y = 1 }\nend = { y = 3 }\nduration = 1\n"
                "integrals = [\"sqrt(1 + y'^2) = 2.95\"]\n[guess]\ny = \"1 + 2*t\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const auto width = [&](double a, double height) { return a * std::acosh((height - floor) / a + 1); };
  const auto length = [&](double a) {
    return a * std::sinh(width(a, 1) / a) + a * std::sinh(width(a, 3) / a) + 1 - width(a, 1) - width(a, 3);
  };
  const double a = zero(0.01, 0.3, [&](double x) { return length(x) - 2.95; });
  EXPECT_NEAR(solution.extension->integral_multipliers[0], a - floor, 1e-7);
  ASSERT_EQ(solution.contacts->contacts.size(), 1);
  EXPECT_NEAR(solution.contacts->contacts[0].from, width(a, 1), 1e-7);
  EXPECT_NEAR(solution.contacts->contacts[0].to, 1 - width(a, 3), 1e-7);
}

namespace {

const double frequency = 1.7;
const std::string held_oscillator =
    "[system]\ncoordinates = [\"x\"]\nparameters = { k = 2.0 }\nlagrangian = \"x'^2/2 - k*x^2/2\"\n"
    "[boundary]\nstart = { x = 0 }\nend = { x = 0 }\nduration = 1\n";

}  // namespace

/// Between its ends at rest the oscillator is held at 1 in the middle.
TEST_F(FitsTogether, AFrequencyWithAWaypoint) {
  const double w = frequency;
  const FitResult fit =
      fitted(held_oscillator + "[[waypoints]]\nat = 0.5\nx = 1\n[fit]\nparameters = [\"k\"]\n", 1,
             [w](double t) { return std::sin(w * std::min(t, 1 - t)) / std::sin(w / 2); });
  ASSERT_TRUE(fit.solution.converged()) << fit.solution.message;
  EXPECT_NEAR(fit.values[0], w * w, 1e-8);
}

/// x'' = ν − k x with ∫ x dt = 1.
TEST_F(FitsTogether, AFrequencyWithAnIntegral) {
  const double w = frequency, mean = 1 / (1 - 2 * std::tan(w / 2) / w);
  const FitResult fit =
      fitted(held_oscillator + "integrals = [\"x = 1\"]\n[fit]\nparameters = [\"k\"]\n", 1,
             [=](double t) { return mean * (1 - std::cos(w * (t - 0.5)) / std::cos(w / 2)); });
  ASSERT_TRUE(fit.solution.converged()) << fit.solution.message;
  EXPECT_NEAR(fit.values[0], w * w, 1e-8);
  EXPECT_NEAR(fit.solution.extension->integral_multipliers[0], w * w * mean, 1e-7);
}

/// A pendulum in Cartesian coordinates by the motion of its angle: gravity and length, and one coordinate of
/// each end, which determines the other.
TEST_F(FitsTogether, APendulumUnderItsConstraint) {
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + 2.3*cos(a)\"\n[boundary]\n"
                "start = { a = -0.8, p_a = 0.9 }\nduration = 2\n"));
  const FitResult fit = fitted(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 1.8, l = 1.1 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n[boundary]\nduration = "
      "2\n"
      "[guess]\nx = \"sin(-0.8 + 0.6*t)\"\ny = \"-cos(-0.8 + 0.6*t)\"\n[fit]\nparameters = [\"g\", \"l\"]\n",
      2, [&](double t) { return std::sin(coordinate_at(angle, t)); });
  ASSERT_TRUE(fit.solution.converged()) << fit.solution.message;
  ASSERT_EQ(fit.values.size(), 4);
  EXPECT_NEAR(fit.values[0], 2.3, 1e-6);
  EXPECT_NEAR(fit.values[1], 1, 1e-6);
  EXPECT_NEAR(fit.values[2], std::sin(-0.8), 1e-6);
  EXPECT_NEAR(fit.values[3], std::sin(coordinate_at(angle, 2)), 1e-6);
}

/// Where extremals jump from one to another as parameters change, differences are no derivatives.
TEST_F(FitsTogether, ExtremalsThatJumpHaveNoMinimum) {
  const double w = frequency;
  std::string data = "t,x\n";
  for (int k = 1; k < 20; ++k)
    data += fmt::format("{},{:.17g}\n", k / 20.0, std::sin(w * std::min(k, 20 - k) / 20) / std::sin(w / 2));
  write("data.csv", data);
  const Study made = study(held_oscillator + "[[waypoints]]\nat = 0.5\nx = 1\n[fit]\nparameters = [\"k\"]\n" +
                           "data = \"data.csv\"\n");
  Solver solver;
  FitTask task = made.fit->task;
  task.solve = [&](const Problem& problem, const SolveOptions& options) {
    return solver.solve(problem, options);
  };
  task.problem = [of = task.problem](std::span<const double> x, const Guess& guess, double duration) {
    const double moved = x[0] * (1 + 0.1 * std::sin(1e5 * x[0]));
    return of({&moved, 1}, guess, duration);
  };
  const FitResult fit = extremal::fit(task, made.options);
  EXPECT_FALSE(fit.solution.converged());
}

TEST_F(FitsTogether, RefuseUnknowns) {
  write("data.csv", "t,x\n0.5,1\n");
  EXPECT_EQ(
      message("[system]\ncoordinates = [\"x\"]\nparameters = { c = 1.0 }\n"
              "lagrangian = \"x'^2/2 - c*k*x^2/2\"\n[boundary]\nstart = { x = 0 }\nduration = 1\n"
              "unknowns = { k = 2.0 }\nwhere = [\"x(T) = 1\"]\n[fit]\ndata = \"data.csv\"\n"
              "parameters = [\"c\"]\n"),
      "scene.toml:10:1: a fit finds parameters by the data, and unknowns are found by 'where'; name them in "
      "'parameters' of [fit] instead, or leave it out");
}
