#include <fmt/format.h>

#include <cmath>

#include "problem/manifold.hpp"
#include "scenes.hpp"
#include "solution/extension_values.hpp"
#include "study/phase.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// A pendulum of length 1 in Cartesian coordinates, and by its angle.
std::string circle(const std::string& system, const std::string& rest) {
  return "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
         "constraints = [\"x^2 + y^2 = 1\"]\n" +
         system + rest;
}
std::string circle_by_angle(const std::string& system, const std::string& rest) {
  return "[system]\ncoordinates = [\"a\"]\ndefinitions = { x = \"sin(a)\", y = \"-cos(a)\" }\n"
         "lagrangian = \"(x'^2 + y'^2)/2 - y\"\n" +
         system + rest;
}
const std::string circle_ends =
    "[boundary]\nstart = { x = \"sin(0.3)\", y = \"-cos(0.3)\" }\n"
    "end = { x = \"sin(1.2)\", y = \"-cos(1.2)\" }\nduration = 1.0\n";
const std::string circle_ends_by_angle =
    "[boundary]\nstart = { a = 0.3 }\nend = { a = 1.2 }\nduration = 1.0\n";
const std::string drag = "force = { x = \"-0.4*x' + 0.2*t\", y = \"-0.4*y'\" }\n";
const std::string drag_by_angle = "force = { a = \"-0.4*a' + 0.2*t*cos(a)\" }\n";

/// Positions and velocities of the constrained pendulum are those of the angle.
void expect_same_motion(const Study& circle, const Solution& constrained, const Solution& minimal,
                        double accuracy) {
  ASSERT_TRUE(constrained.converged()) << constrained.message;
  ASSERT_TRUE(minimal.converged()) << minimal.message;
  std::vector<double> q(2), v(2), p(2), a(1), rate(1);
  Scratch scratch;
  for (const double tau : {0.0, 0.21, 0.5, 0.83, 1.0}) {
    phase_point(circle.problem, constrained.trajectory, tau * constrained.trajectory.duration(), q, v, p,
                scratch);
    minimal.trajectory.at(tau * minimal.trajectory.duration(), a, rate);
    EXPECT_NEAR(q[0], std::sin(a[0]), accuracy);
    EXPECT_NEAR(q[1], -std::cos(a[0]), accuracy);
    EXPECT_NEAR(v[0], std::cos(a[0]) * rate[0], 100 * accuracy);
    EXPECT_NEAR(v[1], std::sin(a[0]) * rate[0], 100 * accuracy);
  }
}

}  // namespace

TEST_F(Scenes, FrictionOfAConstrainedPendulumIsThatOfTheAngle) {
  const Study s = study(circle(drag, circle_ends));
  const Study angle = study(circle_by_angle(drag_by_angle, circle_ends_by_angle));
  const Solution found = run(s), minimal = run(angle);
  expect_same_motion(s, found, minimal, 1e-10);
  ASSERT_TRUE(found.work && minimal.work);
  EXPECT_NEAR(*found.work, *minimal.work, 1e-9);
  EXPECT_NEAR(found.action, minimal.action, 1e-10);
}

/// A bead on an ellipse that is tilted: friction takes what its energy falls by, and no drift is told.
TEST_F(Scenes, WorkIsTheChangeOfTheEnergyUnderConstraints) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 9.81, c = 0.4 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2/4 + (y - 0.2*x)^2 = 1\"]\n"
      "force = { x = \"-c*x'\", y = \"-c*y'\" }\n[boundary]\nstart = { x = 0, y = -1 }\n"
      "end = { x = 1.2, y = -0.56 }\nduration = 0.9\n");
  const Solution found = run(s);
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.message, "converged");
  std::vector<double> q(2), v(2);
  const auto energy = [&](double t) {
    found.trajectory.at(t, q, v);
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 9.81 * q[1];
  };
  EXPECT_NEAR(found.work.value(), energy(0.9) - energy(0), 1e-9);
}

TEST_F(Scenes, ConstraintForcesBalanceGivenForces) {
  // λ holds what presses against the rod: y'' + 1 − F_y = 2 λ y, and the same in x.
  const Study s = study(circle(drag, circle_ends));
  const Solution found = run(s);
  ASSERT_TRUE(found.converged()) << found.message;
  std::vector<double> q(2), v(2), p(2);
  Scratch scratch;
  for (const double t : {0.1, 0.6, 0.95}) {
    phase_point(s.problem, found.trajectory, t, q, v, p, scratch);
    const double lambda = constraint_forces(s.problem, q, v, t).at(0);
    // q·q'' = −|q'|² on the circle.
    const double radial =
        -(v[0] * v[0] + v[1] * v[1]) + q[1] - (0.2 * t * q[0]) + 0.4 * (v[0] * q[0] + v[1] * q[1]);
    EXPECT_NEAR(2 * lambda, radial, 1e-8);
  }
}

TEST_F(Scenes, ASchemeOfAConstrainedPendulumWithFrictionHasItsOrder) {
  const Solution exact = run(study(circle_by_angle(drag_by_angle, circle_ends_by_angle)));
  std::vector<double> errors;
  for (const int elements : {20, 40}) {
    const std::string scheme = fmt::format("[solve]\nscheme = \"midpoint\"\nelements = {}\n", elements);
    const Solution found = run(study(circle(drag, circle_ends + scheme)));
    ASSERT_TRUE(found.converged()) << found.message;
    std::vector<double> q(2), v(2), a(1), rate(1);
    found.trajectory.at(0.5, q, v);
    exact.trajectory.at(0.5, a, rate);
    errors.push_back(std::hypot(q[0] - std::sin(a[0]), q[1] + std::cos(a[0])));
  }
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.2);
}

TEST_F(Scenes, ALimitCycleUnderConstraintsHasThePeriodAndMultipliersOfTheAngle) {
  const std::string torque =
      "force = { x = \"-y*(1.6 - 0.5*(x*y' - y*x'))\", y = \"x*(1.6 - 0.5*(x*y' - y*x'))\" }\n";
  const std::string closed = "[boundary]\nperiodic = true\nduration = \"free\"\n";
  const Study s = study(
      circle(torque, closed + "[guess]\nduration = 2.0\nx = \"sin(2*pi*t/T)\"\ny = \"-cos(2*pi*t/T)\"\n"));
  const Study angle = study(
      circle_by_angle("force = { a = \"1.6 - 0.5*a'\" }\n",
                      closed + "map = { a = \"a + 2*pi\" }\n[guess]\nduration = 2.0\na = \"2*pi*t/T\"\n"));
  const Solution found = run(s), minimal = run(angle);
  ASSERT_TRUE(found.converged()) << found.message;
  ASSERT_TRUE(minimal.converged()) << minimal.message;
  EXPECT_NEAR(found.trajectory.duration(), minimal.trajectory.duration(), 1e-9);
  ASSERT_TRUE(found.floquet && minimal.floquet);
  ASSERT_EQ(found.floquet->multipliers.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_LT(std::abs(found.floquet->multipliers[k] - minimal.floquet->multipliers[k]), 1e-8);
}

TEST_F(Scenes, AnIntegralUnderConstraintsHasTheMultiplierOfTheAngle) {
  const std::string given = "integrals = [\"x*x' + 2*x = 1.3\"]\n";
  const Study s = study(circle("", circle_ends + given)),
              angle = study(circle_by_angle("", circle_ends_by_angle + given));
  const Solution found = run(s), minimal = run(angle);
  expect_same_motion(s, found, minimal, 1e-10);
  EXPECT_NEAR(found.extension->integral_multipliers.at(0), minimal.extension->integral_multipliers.at(0),
              1e-9);
  EXPECT_EQ(found.morse_index, minimal.morse_index);
}

TEST_F(Scenes, AnUnknownLengthOfARodIsThatOfTheAngle) {
  const std::string system =
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { l = 1.0 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - 9.81*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n";
  const Study s =
      study(system +
            "[boundary]\nstart = { x = 0, y = \"-l\" }\nend = { x = \"l*sin(1)\", y = \"-l*cos(1)\" }\n"
            "duration = 0.5\nunknowns = { l = 1.0 }\nwhere = [\"x(T) = 0.7\"]\n");
  const Study angle = study(
      "[system]\ncoordinates = [\"a\"]\nparameters = { l = 1.0 }\nlagrangian = \"l^2*a'^2/2 + "
      "9.81*l*cos(a)\"\n"
      "[boundary]\nstart = { a = 0 }\nend = { a = 1 }\nduration = 0.5\nunknowns = { l = 1.0 }\n"
      "where = [\"l*sin(a(T)) = 0.7\"]\n");
  const Solution found = run(s), minimal = run(angle);
  ASSERT_TRUE(found.converged()) << found.message;
  ASSERT_TRUE(minimal.converged()) << minimal.message;
  EXPECT_NEAR(found.extension->unknowns.at(0).second, minimal.extension->unknowns.at(0).second, 1e-11);
  EXPECT_NEAR(found.action, minimal.action, 1e-10);
  EXPECT_EQ(found.morse_index, minimal.morse_index);
}

TEST_F(Scenes, EndsThatContradictAnUnknownLengthAreNoSolution) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { l = 1.0 }\n"
                "lagrangian = \"(x'^2 + y'^2)/2 - 9.81*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n"
                "[boundary]\nstart = { x = 0, y = -1.1 }\nend = { x = \"l*sin(1)\", y = \"-l*cos(1)\" }\n"
                "duration = 0.5\nunknowns = { l = 1.0 }\nwhere = [\"x(T) = 0.7\"]\n[solve]\nbudget = 2\n"));
  EXPECT_FALSE(found.converged());
}

TEST_F(Scenes, ATourOnASphereIsMadeOfGreatCircles) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = { x = 1, y = 0, z = 0 }\n"
      "end = { x = 0, y = 0, z = 1 }\nduration = 2\n"
      "[[waypoints]]\nat = \"free\"\nx = 0\ny = 1\nz = 0\n"
      "[[waypoints]]\nat = \"free\"\nx = 0.6\ny = 0\nz = 0.8\n");
  const Solution found = run(s);
  ASSERT_TRUE(found.converged()) << found.message;
  const double length = std::acos(-1.0) + std::acos(0.8);
  EXPECT_NEAR(found.action, length * length / 4, 1e-10);
  EXPECT_NEAR(found.extension->waypoints.at(0).time, 2 * std::acos(0.0) / length, 1e-9);
  // From (−1, 0, 0) to (0.6, 0, 0.8) at one speed.
  const double speed = length / 2;
  EXPECT_NEAR(found.extension->waypoints.at(0).impulse.at(0).second, 1.6 * speed, 1e-8);
}

TEST_F(Scenes, AWaypointOffTheConstraintsIsRefusedWithTheAmount) {
  const std::string sphere =
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = { x = 1, y = 0, z = 0 }\n"
      "end = { x = 0, y = 0, z = 1 }\nduration = 2\n[[waypoints]]\nat = 1.0\n";
  EXPECT_NE(message(sphere + "x = 0\ny = 1\nz = 0.5\n").find("left − right = 0.25"), std::string::npos);
  EXPECT_NE(message(sphere + "x = 0.5\n").find("give all of its coordinates"), std::string::npos);
}

TEST_F(Scenes, ANonlinearEndUnderConstraintsIsTransversal) {
  const std::string ends = "duration = 1.0\nunknowns = { g = 1.0 }\nwhere = [\"z(T) = -0.5\"]\n[guess]\n";
  const std::string law = "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 - g*z\"\n";
  const Study s =
      study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nparameters = { g = 1.0 }\n" + law +
            "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\n"
            "conditions = [\"x(0) = 0.6\", \"y(0) = 0\", \"z(0) = -0.8\", \"x(T)^2 + 2*y(T) = 1\"]\n" +
            ends + "x = \"0.6\"\ny = \"0.5*t\"\nz = \"-0.8\"\n");
  const Study angles = study(
      "[system]\ncoordinates = [\"a\", \"b\"]\nparameters = { g = 1.0 }\n"
      "definitions = { x = \"sin(a)*cos(b)\", y = \"sin(a)*sin(b)\", z = \"-cos(a)\" }\n" +
      law + "[boundary]\nconditions = [\"a(0) = asin(0.6)\", \"b(0) = 0\", \"x(T)^2 + 2*y(T) = 1\"]\n" +
      ends + "a = \"0.7\"\nb = \"0.5*t\"\n");
  const Solution found = run(s), minimal = run(angles);
  ASSERT_TRUE(found.converged()) << found.message;
  ASSERT_TRUE(minimal.converged()) << minimal.message;
  EXPECT_NEAR(found.extension->unknowns.at(0).second, minimal.extension->unknowns.at(0).second, 1e-10);
  EXPECT_NEAR(found.action, minimal.action, 1e-10);
  EXPECT_EQ(found.morse_index, minimal.morse_index);
}

TEST_F(Scenes, ConditionsAndIntegralsThatFollowFromOthersAreRefusedByName) {
  const std::string plane =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n[boundary]\nduration = 1\n";
  const std::string conditions = message(plane +
                                         "conditions = [\"x(0) = 0\", \"y(0) = 0\", \"x(T)^2 + y(T)^2 = 4\", "
                                         "\"(x(T)^2 + y(T)^2)^2 = 16\"]\n");
  EXPECT_NE(conditions.find("the condition '(x(T)^2 + y(T)^2)^2 = 16' follows"), std::string::npos)
      << conditions;
  const std::string integrals =
      message(plane +
              "start = { x = 0, y = 0 }\nend = { x = 1, y = 0 }\nintegrals = [\"x = 1\", \"y = 1\", "
              "\"2*x - 3*y = 1\"]\n");
  EXPECT_NE(integrals.find("the ends and the integrals before it determine the integral '2*x - 3*y = 1'"),
            std::string::npos)
      << integrals;
  EXPECT_EQ(message(plane + "conditions = [\"x(0) = 0\", \"y(0) = 0\", \"x(T)^2 + y(T)^2 = 4\", "
                            "\"x(T)*y(T) = 1\"]\n"),
            "");
}

/// The line from (1, 0) to (−1, 0) passes the centre. The rod moves as its angle does.
TEST_F(Scenes, LinesThroughWaypointsAreBentOntoConstraints) {
  const Study rod =
      study(circle("",
                   "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = 0, y = 1 }\nduration = 2\n"
                   "[[waypoints]]\nat = \"free\"\nx = -1\ny = 0\n"));
  const Solution constrained = run(rod);
  ASSERT_TRUE(constrained.converged()) << constrained.message;
  std::vector<double> q(2), v(2);
  constrained.trajectory.at(constrained.extension->waypoints[0].time / 2, q, v);
  const bool by_top = q[1] > 0;
  const Solution angle = run(study(circle_by_angle(
      "", std::string("[boundary]\nstart = { a = \"pi/2\" }\nend = { a = \"") + (by_top ? "pi" : "-pi") +
              "\" }\nduration = 2\n[[waypoints]]\nat = \"free\"\na = \"" + (by_top ? "3*pi/2" : "-pi/2") +
              "\"\n")));
  ASSERT_TRUE(angle.converged()) << angle.message;
  EXPECT_NEAR(constrained.action, angle.action, 1e-12);
}
