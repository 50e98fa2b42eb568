#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "charts.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "scenes.hpp"
#include "solution/from_minimal.hpp"
#include "solve/solve.hpp"
#include "study/continued.hpp"
#include "study/minimal_family.hpp"
#include "system/minimal_lagrangian.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

const std::string rod =
    "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
    "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\n";
const std::string rod_by_angle =
    "[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + cos(a)\"\n[boundary]\n";

std::string place(double angle) { return fmt::format("{{ x = \"sin({0})\", y = \"-cos({0})\" }}\n", angle); }

const std::string sphere =
    "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
    "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\n";

const Chart& chart(const Study& s) {
  EXPECT_TRUE(s.problem.manifold->parts().minimal);
  return s.problem.manifold->parts().minimal->lagrangian->chart();
}

void expect_same(const Solution& found, const Solution& other, double accuracy = 1e-10) {
  ASSERT_TRUE(found.converged()) << found.message;
  ASSERT_TRUE(other.converged()) << other.message;
  EXPECT_NEAR(found.action, other.action, accuracy * std::max(1.0, std::abs(other.action)));
  EXPECT_NEAR(found.duration(), other.duration(), accuracy);
  EXPECT_EQ(found.morse_index, other.morse_index);
  EXPECT_EQ(found.nullity, other.nullity);
  EXPECT_EQ(found.windows.size(), other.windows.size());
  ASSERT_EQ(found.conjugate_times.size(), other.conjugate_times.size());
  for (std::size_t k = 0; k < other.conjugate_times.size(); ++k)
    EXPECT_NEAR(found.conjugate_times[k], other.conjugate_times[k], 1e-7);
  ASSERT_EQ(found.floquet.has_value(), other.floquet.has_value());
  if (!other.floquet) return;
  ASSERT_EQ(found.floquet->multipliers.size(), other.floquet->multipliers.size());
  for (std::size_t k = 0; k < other.floquet->multipliers.size(); ++k)
    EXPECT_NEAR(std::abs(found.floquet->multipliers[k] - other.floquet->multipliers[k]), 0, 1e-8);
}

/// To roundoff of the squares in the constraints.
void expect_on_manifold(const Study& s, const Trajectory& path) {
  const std::size_t n = path.coordinates;
  double most = 0, size = 0;
  for (std::size_t first = 0; first < path.nodes.size(); first += n) {
    const std::span<const double> q(path.nodes.data() + first, n);
    most = std::max(most, s.problem.manifold->at(q, 0).g.norm());
    for (const double x : q) size = std::max(size, std::abs(x));
  }
  EXPECT_LT(most, 2e-15 * size * size);
}

}  // namespace

TEST_F(Scenes, APendulumThatSwingsThrough240Degrees) {
  const Study s = study(rod + "start = " + place(-2) + "end = " + place(2.2) + "duration = 2.5\n" +
                        "[guess]\nx = \"sin(-2 + 4.2*t/T)\"\ny = \"-cos(-2 + 4.2*t/T)\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  const Solution found = run(s),
                 angle = run(study(rod_by_angle + "start = { a = -2 }\nend = { a = 2.2 }\nduration = 2.5\n"));
  expect_same(found, angle);
  expect_on_manifold(s, found.trajectory);
  std::vector<double> q(2), v(2), a(1), turn(1);
  for (const double t : {0.0, 0.3, 1.1, 2.5}) {
    found.trajectory.at(t, q, v);
    angle.trajectory.at(t, a, turn);
    EXPECT_NEAR(q[0], std::sin(a[0]), 1e-9);
    EXPECT_NEAR(v[1], std::sin(a[0]) * turn[0], 1e-8);
    // λ ∂g/∂q is the tension, and ∂g/∂q has the length 2.
    EXPECT_NEAR(s.problem.manifold->multipliers(q, t, v).front(), -(turn[0] * turn[0] + std::cos(a[0])) / 2,
                1e-6);
  }
  EXPECT_NEAR(found.momentum_start[0], angle.momentum_start[0] * std::cos(-2), 1e-8);
  EXPECT_NEAR(found.momentum_end[1], angle.momentum_end[0] * std::sin(2.2), 1e-8);
}

TEST_F(Scenes, APendulumThatTurnsHasTheMultipliersOfTheAngle) {
  const std::string closed = "periodic = true\nduration = \"free\"\nenergy = 2.5\n",
                    guess = "[guess]\nduration = 3.6\n";
  const Study s = study(rod + closed + guess + "x = \"sin(2*pi*t/T)\"\ny = \"-cos(2*pi*t/T)\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  const Solution found = run(s);
  expect_same(found, run(study(rod_by_angle + closed + "map = { a = \"a + 2*pi\" }\n" + guess +
                               "a = \"2*pi*t/T\"\n")));
  expect_on_manifold(s, found.trajectory);
}

TEST_F(Scenes, AClosedPathThatIsReflectedInPolarCoordinates) {
  const std::string closed = "periodic = true\nduration = \"free\"\nenergy = 0.7\n";
  const Study s = study(rod + closed +
                        "map = { x = \"-x\", y = \"y\" }\n[guess]\nduration = 5.5\n"
                        "x = \"sin(2.3*cos(pi*t/T))\"\ny = \"-cos(2.3*cos(pi*t/T))\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  expect_same(run(s), run(study(rod_by_angle + closed +
                                "map = { a = \"-a\" }\n[guess]\nduration = 5.5\n"
                                "a = \"2.3*cos(pi*t/T)\"\n")));
}

TEST_F(Scenes, AMotionFromInitialDataThatTurnsRound) {
  const Study s = study(rod + "start = { x = 0, y = -1, p_x = 2.2, p_y = 0 }\nduration = 9\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  const Solution found = run(s),
                 angle = run(study(rod_by_angle + "start = { a = 0, p_a = 2.2 }\nduration = 9\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  std::vector<double> q(2), v(2), a(1), turn(1);
  found.trajectory.at(9, q, v);
  angle.trajectory.at(9, a, turn);
  EXPECT_GT(a[0], 2 * std::numbers::pi);
  EXPECT_NEAR(q[0], std::sin(a[0]), 1e-8);
}

TEST_F(Scenes, ACircleWhoseCentreMoves) {
  const std::string ends = "duration = 2\n[guess]\n";
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
      "constraints = [\"(x - 0.2*sin(t))^2 + y^2 = 1\"]\n[boundary]\nstart = " +
      place(-2) + "end = { x = \"sin(2) + 0.2*sin(2)\", y = \"-cos(2)\" }\n" + ends +
      "x = \"sin(-2 + 4*t/T)\"\ny = \"-cos(-2 + 4*t/T)\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  expect_same(run(s),
              run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"((0.2*cos(t) + cos(a)*a')^2 + "
                        "(sin(a)*a')^2)/2 + cos(a)\"\n[boundary]\nstart = { a = -2 }\nend = { a = 2 }\n" +
                        ends + "a = \"-2 + 4*t/T\"\n")));
}

/// A rod whose pivot moves in time as (0.3 sin 2t, 0.1 cos 3t − 0.1), from initial data.
const std::string moving_pivot =
    "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - 3*y\"\n"
    "constraints = [\"(x - 0.3*sin(2*t))^2 + (y - 0.1*cos(3*t) + 0.1)^2 = 1\"]\n[boundary]\n"
    "start = { x = 0.6, y = -0.8, p_x = 0.6, p_y = 0 }\nduration = 5\n";

TEST_F(Scenes, AMotionAboutAPivotThatMoves) {
  const Study s = study(moving_pivot);
  ASSERT_EQ(chart(s).polar.size(), 1u);
  EXPECT_TRUE(chart(s).polar[0].invariants.empty());
  const Solution found = run(s);
  const Solution angle = run(study(
      "[system]\ncoordinates = [\"a\"]\nlagrangian = \"((0.6*cos(2*t) + cos(a)*a')^2 + (sin(a)*a' - "
      "0.3*sin(3*t))^2)/2 + 3*cos(a) - 0.3*cos(3*t)\"\n[boundary]\nstart = { a = \"asin(0.6)\", p_a = 0.48 "
      "}\nduration = 5\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  std::vector<double> q(2), v(2), a(1), turn(1);
  for (const double t : {0.0, 0.4, 1.7, 3.1, 5.0}) {
    found.trajectory.at(t, q, v);
    angle.trajectory.at(t, a, turn);
    EXPECT_NEAR(q[0], 0.3 * std::sin(2 * t) + std::sin(a[0]), 1e-8);
    EXPECT_NEAR(q[1], 0.1 * std::cos(3 * t) - 0.1 - std::cos(a[0]), 1e-8);
    EXPECT_NEAR(v[0], 0.6 * std::cos(2 * t) + std::cos(a[0]) * turn[0], 1e-7);
    EXPECT_NEAR(v[1], -0.3 * std::sin(3 * t) + std::sin(a[0]) * turn[0], 1e-7);
  }
}

/// The radius of a circle that grows about a fixed centre does not depend on the angle.
TEST_F(Scenes, ACircleThatGrowsIsInvariantUnderRotations) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
      "constraints = [\"x^2 + y^2 = (1 + 0.2*sin(t))^2\"]\n[boundary]\n"
      "start = { x = 0.6, y = -0.8, p_x = 0.12, p_y = -0.16 }\nduration = 4\n");
  ASSERT_EQ(chart(s).polar.size(), 1u);
  EXPECT_EQ(chart(s).polar[0].invariants, std::vector<int>{0});
  const Solution found = run(s);
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"(1 + 0.2*sin(t))^2*a'^2/2 + (1 + "
                "0.2*sin(t))*cos(a)\"\n[boundary]\nstart = { a = \"asin(0.6)\", p_a = 0 }\nduration = 4\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  std::vector<double> q(2), v(2), a(1), turn(1);
  found.trajectory.at(4, q, v);
  angle.trajectory.at(4, a, turn);
  EXPECT_NEAR(q[0], (1 + 0.2 * std::sin(4)) * std::sin(a[0]), 1e-8);
}

/// Minimal coordinates of a pivot that rests are those of no motion about one that moves.
TEST_F(Scenes, APathInMinimalCoordinatesThatLeavesTheManifoldIsNoSolution) {
  const std::string resting =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - 3*y\"\n"
      "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\n"
      "start = { x = 0.6, y = -0.8, p_x = 0.8, p_y = 0.6 }\nduration = 5\n";
  const Study s = study(resting), moving = study(moving_pivot);
  ASSERT_TRUE(minimal(s));
  const Solution found = Solver().solve(minimal(s)->problem, s.options);
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_TRUE(from_minimal(s.problem, *minimal(s), found, 1e-7));
  EXPECT_FALSE(from_minimal(moving.problem, *minimal(s), found, 1e-7));
}

/// The pivot rests at first to the last digit.
TEST_F(Scenes, MomentaThatAConstraintMissesByRoundoffAreThoseOfRest) {
  const auto from = [&](const std::string& momentum) {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
        "constraints = [\"(x - 0.5*exp(-((t - 3)/0.3)^2))^2 + y^2 = 1\"]\n[boundary]\n"
        "start = { x = 0.6, y = -0.8, p_x = " +
        momentum + ", p_y = 0 }\nduration = 5\n");
  };
  EXPECT_EQ(from("0"), "");
  EXPECT_NE(from("1e-6"), "");
}

TEST_F(Scenes, AnEllipseIsPassedByItsEccentricAnomaly) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
      "constraints = [\"x^2/4 + (y - 3)^2 = 1\"]\n[boundary]\nstart = { x = 2, y = 3 }\n"
      "end = { x = 0, y = 2 }\nduration = 3\n[guess]\nx = \"2*cos(1.5*pi*t/T)\"\ny = \"3 + "
      "sin(1.5*pi*t/T)\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  expect_same(run(s),
              run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"(4*sin(a)^2 + cos(a)^2)*a'^2/2 - "
                        "sin(a) - 3\"\n[boundary]\nstart = { a = 0 }\nend = { a = \"1.5*pi\" }\n"
                        "duration = 3\n")));
}

/// Conjugate to the start is the antipode, for the first time after π: the index is that of arcs of circles.
TEST_F(Scenes, GreatCirclesBeyondTheAntipode) {
  for (const double arc : {3.5, 8.2}) {
    const auto at = [](double angle) {
      return fmt::format("{{ x = {:.17g}, y = {:.17g}, z = {:.17g} }}\n", std::cos(angle),
                         0.8 * std::sin(angle), 0.6 * std::sin(angle));
    };
    const Study s =
        study(sphere + "start = " + at(0.2) + "end = " + at(0.2 + arc) + "duration = 2\n[guess]\n" +
              fmt::format("x = \"cos(0.2 + {0}*t/T)\"\ny = \"0.9*sin(0.2 + {0}*t/T)\"\n"
                          "z = \"0.4*sin(0.2 + {0}*t/T) + 0.05*sin(pi*t/T)\"\n",
                          arc));
    EXPECT_EQ(chart(s).polar.size(), 1u);
    const Solution found = run(s);
    ASSERT_TRUE(found.converged()) << found.message;
    EXPECT_NEAR(found.action, arc * arc / 4, 1e-11);
    const int passed = static_cast<int>(arc / std::numbers::pi);
    EXPECT_EQ(found.morse_index, passed);
    ASSERT_EQ(found.conjugate_times.size(), static_cast<std::size_t>(passed));
    for (int k = 0; k < passed; ++k)
      EXPECT_NEAR(found.conjugate_times[k], 2 * (k + 1) * std::numbers::pi / arc, 1e-8);
    expect_on_manifold(s, found.trajectory);
  }
}

TEST_F(Scenes, AClosedGreatCircleHasTheMultipliersOfAllCoordinates) {
  const Study s = study(sphere +
                        "periodic = true\nduration = 1\n[guess]\nx = \"cos(2*pi*t/T)\"\n"
                        "y = \"0.8*sin(2*pi*t/T)\"\nz = \"0.6*sin(2*pi*t/T)\"\n");
  const Solution found = run(s), whole = in_all_coordinates(s);
  ASSERT_EQ(found.converged(), whole.converged()) << found.message << whole.message;
  EXPECT_NEAR(found.action, 2 * std::numbers::pi * std::numbers::pi, 1e-10);
}

TEST_F(Scenes, AFourBarLinkageWhoseCrankTurnsRound) {
  // Crank 1, coupler 3, rocker 2.5, ground 3.2. The guess is a linkage at each time.
  const double crank = 1, coupler = 3, rocker = 2.5, ground = 3.2;
  const std::string a = "(0.4 + 2*pi*t/T)", bx = "cos" + a, by = "sin" + a,
                    away = fmt::format("(({} - {})^2 + ({})^2)", bx, ground, by),
                    along =
                        fmt::format("(({} - {} + {})/2/{})", coupler * coupler, rocker * rocker, away, away),
                    across = fmt::format("sqrt({}/{} - {}^2)", coupler * coupler, away, along);
  const double b[2] = {std::cos(0.4), std::sin(0.4)}, far = std::pow(b[0] - ground, 2) + b[1] * b[1],
               part = (coupler * coupler - rocker * rocker + far) / 2 / far,
               aside = std::sqrt(coupler * coupler / far - part * part);
  const std::string end = fmt::format("{{ x = [{:.17g}, {:.17g}], y = [{:.17g}, {:.17g}] }}\n", b[0],
                                      b[0] + part * (ground - b[0]) + aside * b[1], b[1],
                                      b[1] - part * b[1] + aside * (ground - b[0]));
  const auto scene = [&](const std::string& boundary) {
    return fmt::format(
        "[system]\ncoordinates = [\"x[2]\", \"y[2]\"]\n"
        "lagrangian = \"sum(i, 1, 2, (x[i]'^2 + y[i]'^2)/2 - y[i])\"\n"
        "constraints = [\"x[1]^2 + y[1]^2 = {}\", \"(x[2] - {})^2 + y[2]^2 = {}\", "
        "\"(x[2] - x[1])^2 + (y[2] - y[1])^2 = {}\"]\n[boundary]\n{}"
        "x = [\"{}\", \"{} + {}*({} - {}) + {}*{}\"]\ny = [\"{}\", \"{} - {}*{} + {}*({} - {})\"]\n",
        crank * crank, ground, rocker * rocker, coupler * coupler, boundary, bx, bx, along, ground, bx,
        across, by, by, by, along, by, across, ground, bx);
  };
  const Study s = study(scene("start = " + end + "end = " + end + "duration = 1.8\n[guess]\n"));
  EXPECT_EQ(chart(s).polar.size(), 2u);
  EXPECT_EQ(chart(s).free, 1);
  const Solution found = run(s);
  expect_same(found, in_all_coordinates(s), 1e-9);
  expect_on_manifold(s, found.trajectory);

  const Study closed =
      study(scene("periodic = true\nduration = \"free\"\nenergy = 20\n[guess]\nduration = 1.5\n"));
  EXPECT_EQ(chart(closed).polar.size(), 2u);
  expect_same(run(closed), in_all_coordinates(closed), 1e-8);
}

/// A chain of so many rods that the last place depends much on each angle; it turns through 220 degrees.
TEST_F(Scenes, AChainOfRodsThatTurnsFar) {
  const auto places = [](double angle) {
    std::string x, y;
    for (int i = 1; i <= 8; ++i) {
      x += fmt::format("{}{:.17g}", i > 1 ? ", " : "", i * std::sin(angle) / 8);
      y += fmt::format("{}{:.17g}", i > 1 ? ", " : "", -i * std::cos(angle) / 8);
    }
    return fmt::format("{{ x = [{}], y = [{}] }}\n", x, y);
  };
  std::string constraints = "\"x[1]^2 + y[1]^2 = 1/64\"", x, y;
  for (int i = 1; i <= 8; ++i) {
    if (i > 1) constraints += fmt::format(", \"(x[{0}] - x[{1}])^2 + (y[{0}] - y[{1}])^2 = 1/64\"", i, i - 1);
    x += fmt::format("{}\"{}/8*sin(-1.8 + 3.8*t/T)\"", i > 1 ? ", " : "", i);
    y += fmt::format("{}\"-{}/8*cos(-1.8 + 3.8*t/T)\"", i > 1 ? ", " : "", i);
  }
  const Study s = study(
      "[system]\ncoordinates = [\"x[8]\", \"y[8]\"]\nlagrangian = \"sum(i, 1, 8, (x[i]'^2 + y[i]'^2)/2)\"\n"
      "constraints = [" +
      constraints + "]\n[boundary]\nstart = " + places(-1.8) + "end = " + places(2) +
      "duration = 1\n[guess]\nx = [" + x + "]\ny = [" + y + "]\n");
  EXPECT_EQ(chart(s).polar.size(), 8u);
  const Solution found = run(s);
  ASSERT_TRUE(found.converged()) << found.message;
  // It turns as a rigid body: Σ (i/8)² = 204/64.
  EXPECT_NEAR(found.action, 204. / 64 * 3.8 * 3.8 / 2, 1e-9);
}

TEST_F(Scenes, AGeodesicRoundATorus) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"(sqrt(x^2 + y^2) - 2)^2 + z^2 = 0.25\"]\n[boundary]\n"
      "start = { x = \"2 + 0.5*cos(0.3)\", y = 0, z = \"0.5*sin(0.3)\" }\n"
      "end = { x = \"(2 + 0.5*cos(0.5))*cos(4)\", y = \"(2 + 0.5*cos(0.5))*sin(4)\", z = \"-0.5*sin(0.5)\" "
      "}\n"
      "duration = 1\n[guess]\nx = \"2.4*cos(4*t/T)\"\ny = \"2.4*sin(4*t/T)\"\nz = \"0.1 - 0.3*t/T\"\n");
  EXPECT_EQ(chart(s).polar.size(), 1u);
  expect_same(run(s), run(study("[system]\ncoordinates = [\"a\", \"b\"]\n"
                                "lagrangian = \"((2 + 0.5*cos(b))^2*a'^2 + 0.25*b'^2)/2\"\n[boundary]\n"
                                "start = { a = 0, b = 0.3 }\nend = { a = 4, b = -0.5 }\nduration = 1\n")));
}

/// Of turning orbits in the energy, and of long swings in the length of the rod and in the time.
TEST_F(Scenes, FamiliesInPolarCoordinates) {
  LONG_TEST();
  const auto with_length = [](const std::string& constrained, const std::string& angle) {
    return std::pair{
        "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { l = 1.0 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
        "y\"\n"
        "constraints = [\"x^2 + y^2 = l^2\"]\n[boundary]\n" +
            constrained,
        "[system]\ncoordinates = [\"a\"]\nparameters = { l = 1.0 }\n"
        "lagrangian = \"l^2*a'^2/2 + l*cos(a)\"\n[boundary]\n" +
            angle};
  };
  const std::string closed = "periodic = true\nduration = \"free\"\nenergy = 2.5\n",
                    round = "[guess]\nduration = 3.6\n";
  const auto family = [](const std::string& parameter, double to) {
    return fmt::format("[continuation]\nparameter = \"{}\"\nto = {}\n", parameter, to);
  };
  const std::string from =
                        "start = { x = \"l*sin(-2)\", y = \"-l*cos(2)\" }\nend = { x = \"l*sin(2.2)\", y = "
                        "\"-l*cos(2.2)\" }\nduration = 2.5\n[guess]\nx = \"l*sin(-2 + 4.2*t/T)\"\n"
                        "y = \"-l*cos(-2 + 4.2*t/T)\"\n",
                    from_angle = "start = { a = -2 }\nend = { a = 2.2 }\nduration = 2.5\n";
  const auto turning = with_length(
      closed + round + "x = \"sin(2*pi*t/T)\"\ny = \"-cos(2*pi*t/T)\"\n" + family("energy", 6),
      closed + "map = { a = \"a + 2*pi\" }\n" + round + "a = \"2*pi*t/T\"\n" + family("energy", 6));
  const auto longer = with_length(from + family("l", 1.5), from_angle + family("l", 1.5));
  const auto slower = with_length(from + family("duration", 4), from_angle + family("duration", 4));
  for (const auto& [constrained, angle] : {turning, longer, slower}) {
    const Study s = study(constrained);
    EXPECT_TRUE(follow_in_minimal_coordinates(s, s.options));
    const FollowedBranch found = follow(s), expected = follow(study(angle));
    ASSERT_FALSE(found.points.empty());
    const BranchPoint &last = found.points.back(), &other = expected.points.back();
    EXPECT_NEAR(last.parameter, other.parameter, 1e-12);
    ASSERT_TRUE(last.solution.converged());
    EXPECT_NEAR(last.solution.duration(), other.solution.duration(), 1e-8);
    EXPECT_NEAR(last.solution.action, other.solution.action, 1e-8);
    EXPECT_EQ(last.solution.morse_index, other.solution.morse_index);
    expect_on_manifold(s, found.points.front().solution.trajectory);
  }
}

/// Ends on parallels: turning about the axis leads from one extremal to others.
TEST_F(Scenes, EndsOnParallelsHaveAFamilyOfExtremals) {
  const Solution found = run(
      study(sphere + "start = { z = 0.5 }\nend = { z = -0.5 }\nduration = 1.0\n[guess]\nx = \"sqrt(3)/2\"\n"
                     "y = \"0\"\nz = \"0.5 - t/T\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, std::pow(std::numbers::pi / 3, 2) / 2, 1e-12);
  EXPECT_EQ(found.morse_index, 0);
  EXPECT_EQ(found.nullity, 1);
}

/// At E = −2.32505731392 and −1.64779718936 the multipliers touch −1, where four branches of doubled orbits
/// meet.
TEST_F(Scenes, MultipliersThatTouchMinusOneAreOneDoubling) {
  LONG_TEST();
  const std::string pendulum =
      "[system]\ncoordinates = [\"x\", \"y\", \"u\", \"v\"]\n"
      "lagrangian = \"(x'^2 + y'^2 + u'^2 + v'^2)/2 - (y + v)\"\n"
      "constraints = [\"x^2 + y^2 = 1\", \"(u - x)^2 + (v - y)^2 = 1\"]\n[boundary]\nperiodic = true\n"
      "duration = \"free\"\nenergy = -2.9\n[guess]\nx = \"0.15*sin(2*pi*t/T)\"\ny = \"-1\"\n"
      "u = \"0.36*sin(2*pi*t/T)\"\nv = \"-2\"\nduration = 8.3\n[continuation]\nparameter = \"energy\"\n"
      "to = -1.0\npoints = 60\n";
  for (const std::string tolerance : {"1e-6", "1e-9"}) {
    const FollowedBranch found = follow(study(pendulum + "[solve]\ntolerance = " + tolerance + "\n"));
    std::vector<double> doublings;
    for (const BranchPoint& point : found.points)
      if (point.kind == PointKind::period_doubling) doublings.push_back(point.parameter);
    ASSERT_EQ(doublings.size(), 2u) << tolerance;
    EXPECT_NEAR(doublings[0], -2.32505731392, 1e-8);
    EXPECT_NEAR(doublings[1], -1.64779718936, 1e-8);
  }
  const FollowedBranch all = follow(study(pendulum + "switch = true\n"));
  ASSERT_EQ(all.branches.size(), 5u);
  for (std::size_t k = 1; k < all.branches.size(); ++k)
    EXPECT_EQ(all.branches[k].end, BranchEnd::closed) << all.branches[k].message;
}

TEST_F(Scenes, AFamilyThatRests) {
  const FollowedBranch found = follow(
      study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - x\"\n"
            "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\nstart = { x = -1, y = 0 }\n"
            "end = { x = -1, y = 0 }\nduration = 2\n[continuation]\nparameter = \"duration\"\nto = 4\n"));
  EXPECT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  const auto branch = std::ranges::find(found.points, PointKind::branch, &BranchPoint::kind);
  ASSERT_NE(branch, found.points.end());
  EXPECT_NEAR(branch->parameter, std::numbers::pi, 1e-9);
}
