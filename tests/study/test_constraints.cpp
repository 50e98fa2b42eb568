#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "problem/manifold.hpp"
#include "scenes.hpp"
#include "study/continued.hpp"
#include "study/phase.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

std::string pendulum(const std::string& boundary, const std::string& constraints = "\"x^2 + y^2 = l^2\"") {
  return "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { m = 1.5, l = 2.0, g = 9.81 }\n"
         "lagrangian = \"m*(x'^2 + y'^2)/2 - m*g*y\"\nconstraints = [" +
         constraints + "]\n[boundary]\n" + boundary;
}

std::string by_angle(const std::string& boundary) {
  return "[system]\ncoordinates = [\"a\"]\nparameters = { m = 1.5, l = 2.0, g = 9.81 }\n"
         "lagrangian = \"m*l^2*a'^2/2 + m*g*l*cos(a)\"\n[boundary]\n" +
         boundary;
}

const std::string start = "start = { x = \"l*sin(-0.5)\", y = \"-l*cos(0.5)\" }\n";
const std::string swing = start + "end = { x = \"l*sin(1.2)\", y = \"-l*cos(1.2)\" }\nduration = 1.3\n";
const std::string swing_by_angle = "start = { a = -0.5 }\nend = { a = 1.2 }\nduration = 1.3\n";

/// Largest |g| at the nodes, over the size of the coordinates.
double missed(const Problem& problem, const Trajectory& trajectory) {
  const std::size_t n = problem.coordinates();
  double most = 0;
  for (std::size_t first = 0; first < trajectory.nodes.size(); first += n)
    most = std::max(most, problem.manifold->at({trajectory.nodes.data() + first, n}, 0).g.norm());
  return most;
}

void expect_same(const Solution& constrained, const Solution& minimal, double accuracy) {
  ASSERT_TRUE(constrained.converged()) << constrained.message;
  ASSERT_TRUE(minimal.converged()) << minimal.message;
  EXPECT_NEAR(constrained.action, minimal.action, accuracy * std::abs(minimal.action));
  ASSERT_EQ(constrained.energy.has_value(), minimal.energy.has_value());
  if (minimal.energy) {
    EXPECT_NEAR(*constrained.energy, *minimal.energy, 1e3 * accuracy);
  }
  EXPECT_EQ(constrained.morse_index, minimal.morse_index);
  EXPECT_EQ(constrained.nullity, minimal.nullity);
  ASSERT_EQ(constrained.windows.size(), minimal.windows.size());
  ASSERT_EQ(constrained.conjugate_times.size(), minimal.conjugate_times.size());
  for (std::size_t k = 0; k < minimal.conjugate_times.size(); ++k)
    EXPECT_NEAR(constrained.conjugate_times[k], minimal.conjugate_times[k], 1e3 * accuracy);
}

}  // namespace

TEST_F(Scenes, APendulumInCartesianCoordinatesIsThatOfTheAngle) {
  const Study s = study(pendulum(swing)), angle = study(by_angle(swing_by_angle));
  const Solution found = run(s), minimal = run(angle);
  expect_same(found, minimal, 1e-11);
  EXPECT_LT(missed(s.problem, found.trajectory), 2e-15);
  // p = m l a' (cos a, sin a)
  const double turning = minimal.momentum_start[0] / 2;
  EXPECT_NEAR(found.momentum_start[0], turning * std::cos(0.5), 1e-8);
  EXPECT_NEAR(found.momentum_start[1], turning * std::sin(-0.5), 1e-8);
}

TEST_F(Scenes, TheForceOfAConstraintIsTheTensionOfTheRod) {
  const Study s = study(pendulum(swing)), angle = study(by_angle(swing_by_angle));
  const Solution found = run(s), minimal = run(angle);
  Scratch scratch;
  std::vector<double> q(2), v(2), p(2), a(1), turn(1);
  for (const double t : {0.0, 0.31, 0.77, 1.3}) {
    phase_point(s.problem, found.trajectory, t, q, v, p, scratch);
    minimal.trajectory.at(t, a, turn);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1], 4, 4e-15);
    EXPECT_NEAR(q[0] * v[0] + q[1] * v[1], 0, 1e-14);
    EXPECT_NEAR(q[0], 2 * std::sin(a[0]), 1e-9);
    // λ ∂g/∂q is the tension m l a'² + m g cos a towards the support, and ∂g/∂q has the length 2 l.
    const double tension = 1.5 * (2 * turn[0] * turn[0] + 9.81 * std::cos(a[0]));
    EXPECT_NEAR(s.problem.manifold->multipliers(q, t, v).front(), -tension / 4, 1e-6);
  }
}

TEST_F(Scenes, AFreeEndOfAConstrainedPath) {
  const Solution found = run(study(pendulum(start + "duration = 2\n"))),
                 minimal = run(study(by_angle("start = { a = -0.5 }\nduration = 2\n")));
  expect_same(found, minimal, 1e-10);
  EXPECT_EQ(found.morse_index, 1);
  for (const double p : found.momentum_end) EXPECT_NEAR(p, 0, 1e-8);
}

TEST_F(Scenes, CoordinatesOfAnEndThatFollowFromTheOthers) {
  const std::string ends = "start = { x = \"l*sin(-0.5)\" }\nend = { x = \"l*sin(1.2)\" }\nduration = 1.3\n";
  const Study s = study(pendulum(ends + "[guess]\nx = \"0.1\"\ny = \"-2\"\n"));
  expect_same(run(s), run(study(by_angle(swing_by_angle))), 1e-11);
  EXPECT_EQ(s.problem.ends.free, 0);
}

TEST_F(Scenes, ClosedConstrainedPathsHaveTheMultipliersOfTheManifold) {
  const std::string periodic = "periodic = true\nduration = \"free\"\nenergy = -8\n[guess]\nduration = 3.1\n";
  const Solution found = run(
      study(pendulum(periodic + "x = \"l*sin(1.2*cos(2*pi*t/T))\"\ny = \"-l*cos(1.2*cos(2*pi*t/T))\"\n")));
  const Solution minimal = run(study(by_angle(periodic + "a = \"1.2*cos(2*pi*t/T)\"\n")));
  expect_same(found, minimal, 1e-10);
  EXPECT_NEAR(found.duration(), minimal.duration(), 1e-9);
  ASSERT_TRUE(found.floquet && minimal.floquet);
  EXPECT_EQ(found.floquet->multipliers, minimal.floquet->multipliers);
  EXPECT_EQ(found.floquet->real_pairs, 0);
  EXPECT_TRUE(found.floquet->stable());
}

/// Around the vertical with the rate Ω, at the height z = −1/Ω²: seen turning, small motions have the
/// frequency Ω √(1 + 3 cos²θ).
TEST_F(Scenes, AConicalPendulumSeenFromATurningFrame) {
  const double rate = 1.3, height = 1 / (rate * rate), radius = std::sqrt(1 - height * height);
  const Solution found = run(study(fmt::format(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nperiodic = true\nduration = 1.0\n"
      "map = {{ x = \"cos({0})*x - sin({0})*y\", y = \"sin({0})*x + cos({0})*y\" }}\n"
      "[guess]\nx = \"0.8*cos({0}*t/T)\"\ny = \"0.8*sin({0}*t/T)\"\nz = \"-0.6\"\n",
      rate)));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, rate * rate * radius * radius / 2 + height, 1e-12);
  ASSERT_TRUE(found.floquet);
  ASSERT_EQ(found.floquet->multipliers.size(), 4u);
  const double turned = rate * std::sqrt(1 + 3 * height * height);
  EXPECT_NEAR(found.floquet->multipliers[2].real(), std::cos(turned), 1e-10);
  EXPECT_NEAR(std::abs(found.floquet->multipliers[2].imag()), std::abs(std::sin(turned)), 1e-10);
}

TEST_F(Scenes, ADoublePendulumInCartesianCoordinates) {
  const Study s = study(
      "[system]\ncoordinates = [\"x[2]\", \"y[2]\"]\n"
      "lagrangian = \"sum(i, 1, 2, (x[i]'^2 + y[i]'^2)/2 - 9.81*y[i])\"\n"
      "constraints = [\"x[1]^2 + y[1]^2 = 1\", \"(x[2] - x[1])^2 + (y[2] - y[1])^2 = 1\"]\n[boundary]\n"
      "start = { x = [\"sin(0.3)\", \"sin(0.3) + sin(-0.4)\"], y = [\"-cos(0.3)\", \"-cos(0.3) - "
      "cos(-0.4)\"] }\n"
      "end = { x = [\"sin(0.5)\", \"sin(0.5) + sin(0.9)\"], y = [\"-cos(0.5)\", \"-cos(0.5) - cos(0.9)\"] }\n"
      "duration = 0.5\n");
  const Solution found = run(s),
                 minimal = run(study("[system]\ncoordinates = [\"a\", \"b\"]\nlagrangian = \"a'^2 + b'^2/2 + "
                                     "a'*b'*cos(a - b) + 2*9.81*cos(a) + 9.81*cos(b)\"\n[boundary]\n"
                                     "start = { a = 0.3, b = -0.4 }\nend = { a = 0.5, b = 0.9 }\n"
                                     "duration = 0.5\n"));
  expect_same(found, minimal, 1e-10);
  EXPECT_LT(missed(s.problem, found.trajectory), 4e-15);
}

TEST_F(Scenes, AConstraintThatMovesInTime) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
                "constraints = [\"(x - 0.3*sin(2*t))^2 + y^2 = 1\"]\n[boundary]\n"
                "start = { x = \"sin(0.4)\", y = \"-cos(0.4)\" }\n"
                "end = { x = \"0.3*sin(4) + sin(1)\", y = \"-cos(1)\" }\nduration = 2\n"));
  expect_same(found,
              run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"((0.6*cos(2*t) + cos(a)*a')^2 + "
                        "(sin(a)*a')^2)/2 + cos(a)\"\n[boundary]\nstart = { a = 0.4 }\nend = { a = 1 }\n"
                        "duration = 2\n")),
              1e-11);
  EXPECT_FALSE(found.energy);
}

TEST_F(Scenes, GreatCirclesAreTheGeodesicsOfASphere) {
  const double angle = std::acos(0.36 * std::cos(2.0) + 0.64);
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
                "constraints = [\"x^2 + y^2 + z^2 = 9\"]\n[boundary]\nstart = { x = 1.8, y = 0, z = 2.4 }\n"
                "end = { x = \"1.8*cos(2)\", y = \"1.8*sin(2)\", z = 2.4 }\nduration = 1\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, 9 * angle * angle / 2, 1e-10);
  EXPECT_TRUE(found.minimizing);
}

TEST_F(Scenes, InitialDataOnAManifold) {
  const Solution found =
      run(study(pendulum("start = { x = 2, y = 0, p_x = 0, p_y = 0.9 }\nduration = 12\n")));
  const Solution minimal = run(study(by_angle("start = { a = \"pi/2\", p_a = 1.8 }\nduration = 12\n")));
  ASSERT_TRUE(found.converged() && minimal.converged()) << found.message;
  std::vector<double> q(2), v(2), a(1), turn(1);
  found.trajectory.at(12, q, v);
  minimal.trajectory.at(12, a, turn);
  EXPECT_NEAR(q[0], 2 * std::sin(a[0]), 1e-7);
  EXPECT_NEAR(q[1], -2 * std::cos(a[0]), 1e-7);
}

TEST_F(Scenes, FamiliesOfConstrainedOrbits) {
  const std::string rest = "duration = 3.1\n", family = "[continuation]\nparameter = \"l\"\nto = 1.5\n";
  const std::string periodic = "periodic = true\nduration = \"free\"\nenergy = -8\n[guess]\n" + rest;
  const FollowedBranch found = follow(study(
      pendulum(periodic + "x = \"l*sin(1.2*cos(2*pi*t/T))\"\ny = \"-l*cos(1.2*cos(2*pi*t/T))\"\n" + family)));
  const FollowedBranch minimal = follow(study(by_angle(periodic + "a = \"1.2*cos(2*pi*t/T)\"\n" + family)));
  ASSERT_FALSE(found.points.empty());
  const Solution &last = found.points.back().solution, &expected = minimal.points.back().solution;
  EXPECT_EQ(found.points.back().parameter, 1.5);
  EXPECT_NEAR(last.duration(), expected.duration(), 1e-8);
  ASSERT_TRUE(last.floquet);
  EXPECT_EQ(last.floquet->multipliers.size(), 2u);
  EXPECT_NEAR(std::hypot(last.trajectory.nodes[0], last.trajectory.nodes[1]), 1.5, 1e-14);
}

/// Hanging at rest there are no momenta, but forces that cancel. With both ends held there in a time of 2 the
/// second variation is singular where √(g/l)·2 = π.
TEST_F(Scenes, BranchPointsOfAConstrainedBodyAtRest) {
  const FollowedBranch found =
      follow(study("[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 2.0 }\n"
                   "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2 + y^2 = 1\"]\n"
                   "[boundary]\nstart = { x = 0, y = -1 }\nend = { x = 0, y = -1 }\nduration = 2\n"
                   "[continuation]\nparameter = \"g\"\nto = 3\npoints = 20\n"));
  std::vector<double> branches;
  for (const BranchPoint& point : found.points)
    if (point.kind == PointKind::branch) branches.push_back(point.parameter);
  ASSERT_EQ(branches.size(), 1u);
  EXPECT_NEAR(branches[0], std::numbers::pi * std::numbers::pi / 4, 1e-8);
  EXPECT_EQ(found.points.back().parameter, 3);
  EXPECT_EQ(found.points.back().solution.morse_index, 1);
}

TEST_F(Scenes, NodesOfASchemeAreOnTheManifold) {
  const double exact = run(study(by_angle(swing_by_angle))).action;
  double before = 0;
  for (const int elements : {8, 16, 32}) {
    const Study s =
        study(pendulum(swing + fmt::format("[solve]\nscheme = \"lobatto(2)\"\nelements = {}\n", elements)));
    const Solution found = run(s);
    ASSERT_TRUE(found.converged()) << found.message;
    EXPECT_LT(missed(s.problem, found.trajectory), 2e-15);
    const double error = std::abs(found.action - exact);
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 4, 0.4);
    }
    before = error;
  }
}

TEST_F(Scenes, SeveralExtremalsKeepTheConstraints) {
  LONG_TEST();
  const Study s = study(pendulum(swing + "[search]\nsolutions = 3\n"));
  for (const Solution& solution : run_all(s)) {
    ASSERT_TRUE(solution.converged()) << solution.message;
    EXPECT_LT(missed(s.problem, solution.trajectory), 4e-15);
  }
}

/// Ends of an angle that differ by whole turns are one point of the circle.
TEST_F(Scenes, ExtremalsOnACircleAreThoseOfAllTurnsOfTheAngle) {
  LONG_TEST();
  const std::string rest = "duration = 2.2\n[search]\nsolutions = 6\n";
  std::vector<double> expected;
  for (int turns = -2; turns <= 2; ++turns)
    for (const Solution& s :
         run_all(study(fmt::format("[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + 9.81*cos(a)\"\n"
                                   "[boundary]\nstart = {{ a = 0.7 }}\nend = {{ a = \"-0.4 + {}*pi\" }}\n",
                                   2 * turns) +
                       rest)))
      expected.push_back(s.action);
  std::ranges::sort(expected);
  const std::vector<Solution> found =
      run_all(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - 9.81*y\"\n"
                    "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\n"
                    "start = { x = \"sin(0.7)\", y = \"-cos(0.7)\" }\n"
                    "end = { x = \"-sin(0.4)\", y = \"-cos(0.4)\" }\n" +
                    rest));
  ASSERT_EQ(found.size(), 6u);
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k].action, expected[k], 1e-8 * std::abs(expected[k])) << k;
}

/// Great circles both ways round, once and twice, and no arc between points that look alike from the end.
TEST_F(Scenes, GreatCirclesOfSeveralTurns) {
  LONG_TEST();
  const std::vector<Solution> found =
      run_all(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
                    "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = { x = 1, y = 0, z = 0 }\n"
                    "end = { x = 0.6, y = 0.8, z = 0 }\nduration = 1\n[search]\nsolutions = 4\n"));
  const double arc = std::acos(0.6), turn = 2 * std::numbers::pi;
  const double lengths[] = {arc, turn - arc, turn + arc, 2 * turn - arc};
  ASSERT_EQ(found.size(), std::size(lengths));
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k].action, lengths[k] * lengths[k] / 2, 1e-8 * found[k].action) << k;
}

TEST_F(Scenes, ConstraintsThatAreWrong) {
  const auto constraint = [&](const std::string& texts) { return message(pendulum(swing, texts)); };
  EXPECT_EQ(constraint("\"x*x' = l\""),
            "scene.toml:5:19: 'x' stands for velocities; a constraint holds between coordinates, and its "
            "derivative by time follows");
  EXPECT_EQ(constraint("\"abs(x) = l\""),
            "scene.toml:5:17: a constraint must be smooth, without abs, min, max and step");
  EXPECT_EQ(constraint("\"x^2 + y^2\""), "scene.toml:5:26: '=' is missing: write left = right");
  EXPECT_EQ(constraint("\"l = 2\""),
            "scene.toml:5:17: the constraint depends on no coordinate; leave it out");
  EXPECT_EQ(
      constraint("\"x^2 + y^2 = l^2\", \"x = y\""),
      "scene.toml:5:36: 2 constraints leave no motion to 2 coordinates; fewer than 2 can hold: leave out "
      "those that follow from others");
  EXPECT_EQ(message(pendulum("start = { x = 1.2, y = -1.5 }\nduration = 1\n")),
            "scene.toml:7:11: the start does not satisfy the constraint 'x^2 + y^2 = l^2': left − right = "
            "-0.31 there; give values that do, or leave out coordinates that follow from the others");
  EXPECT_EQ(message(pendulum("start = { x = 2, y = 0, p_x = 0.5, p_y = 0.9 }\nduration = 12\n")),
            "scene.toml:7:11: the momenta at the start are those of a velocity that leaves the constraints: "
            "p_x is 0.5, and 0 keeps them");
}

/// At x = 0 the gradient of x² vanishes, though x² = 1 is missed.
TEST_F(Scenes, AnEndWhereTheGradientOfAConstraintVanishes) {
  EXPECT_EQ(
      message("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n"
              "constraints = [\"x^2 = 1\"]\n[boundary]\nstart = { x = 1, y = 0 }\n"
              "end = { x = 0, y = 0.5 }\nduration = 1\n"),
      "scene.toml:7:9: the end does not satisfy the constraint 'x^2 = 1': left − right = -1 there; give "
      "values that do, or leave out coordinates that follow from the others");
}

TEST_F(Scenes, ConstraintsThatDependOnEachOther) {
  const auto plane = [&](const std::string& second) {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
        "constraints = [\"x^2 + y^2 = 1\", \"" +
        second +
        "\"]\n[boundary]\nstart = { x = 1, y = 0, z = 0 }\nend = { x = 0, y = 1, z = 1 }\n"
        "duration = 1\n");
  };
  EXPECT_EQ(plane("x^2 + y^2 = 2"),
            "scene.toml:4:34: the gradient of the constraint 'x^2 + y^2 = 2' is made of those of the ones "
            "before it, or vanishes, but where these hold it is missed by 1; leave it out, or give a guess "
            "where it is regular");
  EXPECT_EQ(plane("2 - 2*x^2 = 2*y^2"),
            "scene.toml:4:34: the constraint '2 - 2*x^2 = 2*y^2' follows from the ones before it; leave it "
            "out");
  EXPECT_EQ(plane("x^2 + y^2 = 4").substr(0, 84),
            "scene.toml:4:34: the gradient of the constraint 'x^2 + y^2 = 4' is made of those of ");
  // The sphere and the cylinder have a circle in common, on which their gradients agree.
  EXPECT_EQ(
      message("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
              "constraints = [\"x^2 + y^2 + z^2 = 1\", \"x^2 + y^2 = 1\"]\n[boundary]\n"
              "start = { x = 1, y = 0, z = 0 }\nend = { x = 0, y = 1, z = 0 }\nduration = 1\n"),
      "scene.toml:4:40: the constraint 'x^2 + y^2 = 1' touches the ones before it: its gradient is made "
      "of theirs wherever all hold, though it does not follow from them; give the points where all hold "
      "by constraints with independent gradients");
}

/// A power of a constraint, also multiplied out, and a product with one that holds; cones at their tips.
TEST_F(Scenes, ConstraintsWithoutAGradient) {
  const auto on = [&](const std::string& constraints, const std::string& start, const std::string& end,
                      const std::string& guess = "") {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
        "constraints = [" +
        constraints + "]\n[boundary]\nstart = " + start + "\nend = " + end + "\nduration = 1\n" + guess);
  };
  const std::string start = "{ x = 2, y = 0, z = 0.5 }", end = "{ x = 0, y = 2, z = 1 }";
  for (const char* power :
       {"(x^2 + y^2 - 4)^2 = 0", "(x^2 + y^2 - 4)^3 = 0", "(x^2 + y^2)^2 + 16 = 8*(x^2 + y^2)"})
    EXPECT_EQ(
        on(fmt::format("\"{}\"", power), start, end),
        fmt::format("scene.toml:4:17: the gradient of the constraint '{}' vanishes where it holds, near the "
                    "guess, as that of a square does; write it without a power",
                    power));
  EXPECT_EQ(
      on("\"x^2 + y^2 = 4\", \"z*(x^2 + y^2 - 4) = 0\"", start, end),
      "scene.toml:4:34: the constraint 'z*(x^2 + y^2 - 4) = 0' follows from the ones before it; leave it "
      "out");
  const std::string cone = "\"x^2 + y^2 = 2*z^2\"";
  EXPECT_EQ(
      on(cone, "{ x = 0, y = 0, z = 0 }", "{ x = 1, y = 1, z = 1 }"),
      "scene.toml:6:11: the gradients of the constraints vanish, or depend on each other, at the start; "
      "move this end");
  const std::string through = "[guess]\nx = \"1 - 2*t\"\ny = \"1 - 2*t\"\nz = \"1 - 2*t\"\n";
  EXPECT_EQ(
      on(cone, "{ x = 1, y = 1, z = 1 }", "{ x = -1, y = -1, z = -1 }", through),
      "scene.toml:9:1: the gradients of the constraints vanish, or depend on each other, on the guess at t "
      "= 0.5: x = 0, y = 0, z = 0; give one that goes past");
}

/// The sphere and a plane beside it; a plane through it that misses what is given at the start.
TEST_F(Scenes, ConstraintsThatContradict) {
  const auto sphere = [&](const std::string& constraints) {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
        "constraints = [" +
        constraints + "]\n[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 0, y = 1 }\nduration = 1\n");
  };
  const std::string unit = "\"x^2 + y^2 + z^2 = 1\"";
  EXPECT_EQ(sphere(unit + ", \"z = 2\""),
            "scene.toml:4:40: the constraint 'z = 2' contradicts the ones before it near the guess: left − "
            "right = -1 is the least there; correct it, or give a guess near points where all constraints "
            "hold");
  EXPECT_EQ(sphere("\"z = 2\", " + unit),
            "scene.toml:4:26: the constraint 'x^2 + y^2 + z^2 = 1' contradicts the ones before it near the "
            "guess: left − right = 3 is the least there; correct it, or give a guess near points where all "
            "constraints hold");
  EXPECT_EQ(
      sphere(unit + ", \"z = 0.9\""),
      "scene.toml:6:11: no point near the guess satisfies both the constraints and what is given at the "
      "start: of 'z = 0.9' left − right = 0.1 remains; give other values");
}

TEST_F(Scenes, InequalitiesAreNoConstraintsOfASystem) {
  EXPECT_EQ(message("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n"
                    "constraints = [\"x^2 + y^2 >= 1\"]\n[boundary]\nstart = { x = 1, y = 0 }\n"
                    "end = { x = 0, y = 1 }\nduration = 1\n"),
            "scene.toml:4:27: unexpected '>': formulas and equations have no comparisons; inequalities along "
            "the path are the 'constraints' of [path]");
}

/// At the pole of the sphere, and at the side of a circle, two values of the coordinate that is left out
/// join.
TEST_F(Scenes, AnEndThatConstraintsHoldInASinglePointIsFound) {
  const auto sphere = [](const std::string& end, const std::string& rest = "") {
    return "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nconstraints = [\"x^2 + y^2 + z^2 = 1\"]\n"
           "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 - 9.81*z\"\n[boundary]\n"
           "start = { x = 1, y = 0, z = 0 }\nend = { " +
           end + " }\nduration = 0.7\n" + rest;
  };
  const Solution given = run(study(sphere("x = 0, y = 1, z = 0"))),
                 found = run(study(sphere("x = 0, y = 1")));
  ASSERT_TRUE(given.converged()) << given.message;
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, given.action, 1e-9);
  const Study s = study(sphere("x = 0, y = 0.8", "[guess]\nx = \"1 - t/T\"\ny = \"t/T\"\nz = -0.4\n"));
  EXPECT_NEAR(s.problem.ends.offset[5], -0.6, 1e-12);
  EXPECT_TRUE(run(s).converged());
  const std::string rod =
      "[system]\ncoordinates = [\"x\", \"y\"]\nconstraints = [\"x^2 + y^2 = 1\"]\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - y\"\n[boundary]\nstart = { x = 1 }\nend = { x = 0 }\nduration = 1\n";
  EXPECT_EQ(message(rod).rfind("scene.toml:7:9: no point near the guess satisfies both", 0), 0u)
      << message(rod);
  const Study below = study(rod + "[guess]\nx = \"cos(pi*t/2/T)\"\ny = \"-sin(pi*t/2/T)\"\n");
  EXPECT_NEAR(below.problem.ends.offset[1], 0, 1e-12);
  EXPECT_NEAR(below.problem.ends.offset[3], -1, 1e-12);
  EXPECT_TRUE(run(below).converged());
}

TEST_F(Scenes, EndsOnDifferentBranchesAreToldApart) {
  LONG_TEST();
  const auto between = [](const std::string& constraint, const std::string& start, const std::string& end) {
    return fmt::format(
        "[system]\ncoordinates = [\"x\", \"y\"]\nconstraints = [\"{}\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n"
        "[boundary]\nstart = {{ {} }}\nend = {{ {} }}\nduration = 1\n",
        constraint, start, end);
  };
  for (const std::string& scene :
       {between("y^2 = 0.01", "x = 0, y = 0.1", "x = 1, y = -0.1"),
        between("x*y = 1", "x = 0.5, y = 2", "x = -1, y = -1"),
        between("(x^2 + y^2 - 1)*(x^2 + y^2 - 4) = 0", "x = 1, y = 0", "x = 0, y = 2")}) {
    const Solution found = run(study(scene));
    EXPECT_EQ(found.status, Status::no_solution_near) << scene;
    EXPECT_NE(found.message.find("does not lead to the end"), std::string::npos) << found.message;
  }
}
