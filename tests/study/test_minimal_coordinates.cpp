#include <fmt/format.h>

#include <cmath>

#include "charts.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "scenes.hpp"
#include "study/phase.hpp"
#include "system/minimal_lagrangian.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

const std::string pendulum =
    "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
    "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\n";

std::string swing(double from, double to, double duration) {
  return pendulum + fmt::format(
                        "start = {{ x = \"sin({0})\", y = \"-cos({0})\" }}\n"
                        "end = {{ x = \"sin({1})\", y = \"-cos({1})\" }}\nduration = {2}\n",
                        from, to, duration);
}

/// A curve on which the distance from a centre depends on the angle.
std::string on_rounded_square(const std::string& boundary, const std::string& guess) {
  return "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
         "constraints = [\"x^4 + y^4 = 1\"]\n[boundary]\n" +
         boundary + "[guess]\n" + guess;
}

/// Two rods, of which the first is held where it moves; a slider whose place is no root of a quadratic.
const std::string mechanism =
    "[system]\ncoordinates = [\"x\", \"y\", \"u\", \"s\"]\n"
    "lagrangian = \"(1.3*x'^2 + y'^2 + u'^2 + 2*s'^2 + x'*u')/2 - y + cos(u)*x - s*u'\"\n"
    "constraints = [\"(x - 0.2*sin(t))^2 + y^2 = 1\", \"s + 0.3*sin(s) = x + u^2/5\"]\n[boundary]\n"
    "start = { x = 0, y = -1, u = 0.3 }\nend = { x = 0.5, u = -0.4 }\nduration = 0.8\n"
    "[guess]\nx = \"0.5*t/T\"\ny = \"-1 + 0.2*t/T\"\nu = \"0.3 - 0.7*t/T\"\ns = \"0.4*t/T\"\n";

}  // namespace

TEST_F(Scenes, MinimalCoordinatesGiveWhatAllCoordinatesGive) {
  const Study s = study(swing(-0.4, 0.9, 2.6));
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s), whole = in_all_coordinates(s);
  ASSERT_TRUE(found.converged() && whole.converged()) << found.message << whole.message;
  EXPECT_LT(2 * found.unknowns, 3 * whole.unknowns);
  EXPECT_NEAR(found.action, whole.action, 1e-11);
  EXPECT_NEAR(*found.energy, *whole.energy, 1e-7);
  EXPECT_EQ(found.morse_index, whole.morse_index);
  ASSERT_EQ(found.conjugate_times.size(), whole.conjugate_times.size());
  for (std::size_t k = 0; k < whole.conjugate_times.size(); ++k)
    EXPECT_NEAR(found.conjugate_times[k], whole.conjugate_times[k], 1e-7);
  for (int a = 0; a < 2; ++a) {
    EXPECT_NEAR(found.momentum_start[a], whole.momentum_start[a], 1e-8);
    EXPECT_NEAR(found.momentum_end[a], whole.momentum_end[a], 1e-8);
  }
  std::vector<double> q(2), v(2), other(2), other_v(2);
  for (const double t : {0.0, 0.7, 1.9, 2.6}) {
    found.trajectory.at(t, q, v);
    whole.trajectory.at(t, other, other_v);
    for (int a = 0; a < 2; ++a) EXPECT_NEAR(q[a], other[a], 3e-9);
    EXPECT_NEAR(s.problem.manifold->multipliers(q, t, v)[0],
                s.problem.manifold->multipliers(other, t, other_v)[0], 1e-7);
  }
}

TEST_F(Scenes, DerivativesInMinimalCoordinates) {
  const Study s = study(mechanism);
  ASSERT_TRUE(minimal(s));
  const MinimalLagrangian& l = *minimal(s)->lagrangian;
  ASSERT_EQ(l.structure().coordinates, 2);
  EXPECT_FALSE(l.structure().autonomous);
  Scratch scratch;
  const double t = 0.37, h = 1e-5;
  const std::vector<double> at{0.21, 0.13, 0.6, -0.8};  // (u, u')
  const auto values = [&](const std::vector<double>& z) {
    return evaluate_at(l, {z.data(), 2}, {z.data() + 2, 2}, t, Order::hessian, scratch);
  };
  const PointValues here = values(at);
  for (int j = 0; j < 4; ++j) {
    std::vector<double> before = at, after = at;
    before[j] -= h;
    after[j] += h;
    const PointValues low = values(before), high = values(after);
    const auto slope = [&](double a, double b) { return (b - a) / (2 * h); };
    EXPECT_NEAR(j < 2 ? here.dq[j] : here.dv[j - 2], slope(low.value, high.value), 1e-8);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(j < 2 ? here.vq[k * 2 + j] : here.vv[k * 2 + j - 2], slope(low.dv[k], high.dv[k]), 1e-8);
      if (j < 2) {
        EXPECT_NEAR(here.qq[k * 2 + j], slope(low.dq[k], high.dq[k]), 1e-8);
      }
    }
  }
}

TEST_F(Scenes, PointsOfAChartAreOnTheManifold) {
  const Study s = study(mechanism);
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s), whole = in_all_coordinates(s);
  ASSERT_TRUE(found.converged() && whole.converged()) << found.message << whole.message;
  EXPECT_NEAR(found.action, whole.action, 1e-11);
  std::vector<double> q(4), v(4);
  for (std::size_t node = 0; node < found.trajectory.nodes.size(); node += 4) {
    std::copy_n(found.trajectory.nodes.begin() + static_cast<std::ptrdiff_t>(node), 4, q.begin());
    const std::size_t each = 4 * static_cast<std::size_t>(found.trajectory.degree + 1);
    const int k = static_cast<int>(node / each);
    const std::size_t j = node % each / 4;
    if (j != 0) continue;  // the time of others is no number of the trajectory
    EXPECT_LT(s.problem.manifold->at(q, found.trajectory.times[k]).g.norm(), 1e-14);
  }
}

TEST_F(Scenes, BeyondAChartLIsNotANumber) {
  const Study s = study(on_rounded_square("start = { x = -0.4 }\nend = { x = 0.5 }\nduration = 1.3\n",
                                          "x = \"-0.4 + 0.9*t/T\"\ny = -1\n"));
  ASSERT_TRUE(minimal(s));
  Scratch scratch;
  const std::vector<double> beyond{1.2}, inside{0.1}, v{0.3};
  EXPECT_TRUE(std::isnan(evaluate_at(*minimal(s)->lagrangian, beyond, v, 0, Order::gradient, scratch).value));
  EXPECT_TRUE(
      std::isfinite(evaluate_at(*minimal(s)->lagrangian, inside, v, 0, Order::gradient, scratch).value));
}

TEST_F(Scenes, AnAngleWhoseRadiusVaries) {
  const auto place = [](double a) {
    const double r = std::pow(std::pow(std::sin(a), 4) + std::pow(std::cos(a), 4), -0.25);
    return fmt::format("{{ x = {:.17g}, y = {:.17g} }}\n", r * std::sin(a), -r * std::cos(a));
  };
  const Study s =
      study(on_rounded_square("start = " + place(-1.4) + "end = " + place(2.6) + "duration = 2.2\n",
                              "x = \"sin(-1.4 + 4*t/T)\"\ny = \"-cos(-1.4 + 4*t/T)\"\n"));
  ASSERT_TRUE(minimal(s));
  EXPECT_EQ(minimal(s)->lagrangian->chart().polar.size(), 1u);
  const Solution found = run(s);
  const std::string root = "(sin(a)^4 + cos(a)^4)";
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"((sin(a)*cos(a)*(cos(a)^2 - sin(a)^2))^2*" +
                root + "^(-2.5) + " + root + "^(-0.5))*a'^2/2 + cos(a)*" + root +
                "^(-0.25)\"\n[boundary]\nstart = { a = -1.4 }\nend = { a = 2.6 }\nduration = 2.2\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message;
  EXPECT_NEAR(found.action, angle.action, 1e-11);
}

/// About the tube of a torus no angle is that of two coordinates.
TEST_F(Scenes, PathsThatNoChartHasAreFoundInAllCoordinates) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"(sqrt(x^2 + y^2) - 2)^2 + z^2 = 1\"]\n[boundary]\nstart = { x = 3, y = 0, z = 0 }\n"
      "end = { x = \"(2 + cos(4))*cos(2.5)\", y = \"(2 + cos(4))*sin(2.5)\", z = \"sin(4)\" }\nduration = 1\n"
      "[guess]\nx = \"(2 + cos(4*t/T))*cos(2.5*t/T)\"\ny = \"(2 + cos(4*t/T))*sin(2.5*t/T)\"\nz = "
      "\"sin(4*t/T)\"\n");
  EXPECT_FALSE(minimal(s));
  const Solution found = run(s);
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\", \"b\"]\n"
                "lagrangian = \"((2 + cos(b))^2*a'^2 + b'^2)/2\"\n[boundary]\n"
                "start = { a = 0, b = 0 }\nend = { a = 2.5, b = 4 }\nduration = 1\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message;
  EXPECT_NEAR(found.action, angle.action, 1e-10);
}

TEST_F(Scenes, AnEndThatConstraintsLinkWithWhatIsFixed) {
  const std::string sphere =
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\n"
      "start = { x = \"sin(1)\", y = 0, z = \"-cos(1)\" }\nend = { z = -0.8 }\nduration = 0.5\n";
  const std::string guess = "[guess]\nx = 0.6\ny = \"0.2*t/T\"\nz = -0.7\n";
  const Study s = study(sphere + guess);
  const Solution found = run(s);
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\", \"b\"]\nlagrangian = \"(a'^2 + sin(a)^2*b'^2)/2 + cos(a)\"\n"
                "[boundary]\nstart = { a = 1, b = 0 }\nend = { a = \"acos(0.8)\" }\nduration = 0.5\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message;
  EXPECT_NEAR(found.action, angle.action, 1e-11);
  EXPECT_EQ(found.morse_index, angle.morse_index);
  std::vector<double> q(3), v(3);
  found.trajectory.at(0.5, q, v);
  EXPECT_NEAR(q[2], -0.8, 1e-14);
  // No momentum along the circle of possible ends.
  EXPECT_NEAR(found.momentum_end[1] * q[0] - found.momentum_end[0] * q[1], 0, 1e-10);

  const std::string refusal =
      "this end is fixed in part, and constraints link what is fixed with what is free";
  EXPECT_NE(message(sphere + guess + "[solve]\nscheme = \"midpoint\"\nelements = 8\n").find(refusal),
            std::string::npos);
}

TEST_F(Scenes, AnEndOfADoublePendulumOfWhichOnePlaceIsGiven) {
  const Solution found = run(study(
      "[system]\ncoordinates = [\"x[2]\", \"y[2]\"]\n"
      "lagrangian = \"sum(i, 1, 2, (x[i]'^2 + y[i]'^2)/2 - y[i])\"\n"
      "constraints = [\"x[1]^2 + y[1]^2 = 1\", \"(x[2] - x[1])^2 + (y[2] - y[1])^2 = 1\"]\n[boundary]\n"
      "conditions = [\"x[1](0) = sin(0.3)\", \"y[1](0) = -cos(0.3)\", \"x[2](0) = sin(0.3) + sin(0.4)\", "
      "\"y[2](0) = -cos(0.3) - cos(0.4)\", \"x[2](T) = 0.9\"]\nduration = 0.5\n[guess]\n"
      "x = [\"0.3 + 0.1*t/T\", \"0.7 + 0.2*t/T\"]\ny = [-0.95, -1.9]\n"));
  const Solution angle = run(
      study("[system]\ncoordinates = [\"a\", \"b\"]\n"
            "lagrangian = \"a'^2 + b'^2/2 + a'*b'*cos(a - b) + 2*cos(a) + cos(b)\"\n[boundary]\n"
            "conditions = [\"a(0) = 0.3\", \"b(0) = 0.4\", \"sin(a(T)) + sin(b(T)) = 0.9\"]\nduration = 0.5\n"
            "[guess]\na = \"0.3 + 0.1*t/T\"\nb = \"0.4 + 0.1*t/T\"\n"));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  EXPECT_NEAR(found.action, angle.action, 1e-11);
}

TEST_F(Scenes, OrbitsClosedByATurnAreFoundInMinimalCoordinates) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nperiodic = true\nduration = 1.0\n"
      "map = { x = \"cos(1.3)*x - sin(1.3)*y\", y = \"sin(1.3)*x + cos(1.3)*y\" }\n"
      "[guess]\nx = \"0.8*cos(1.3*t/T)\"\ny = \"0.8*sin(1.3*t/T)\"\nz = \"-0.6\"\n");
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s), whole = in_all_coordinates(s);
  ASSERT_TRUE(found.converged() && whole.converged()) << found.message;
  ASSERT_TRUE(found.floquet && whole.floquet);
  ASSERT_EQ(found.floquet->multipliers.size(), whole.floquet->multipliers.size());
  for (std::size_t k = 0; k < whole.floquet->multipliers.size(); ++k)
    EXPECT_NEAR(std::abs(found.floquet->multipliers[k] - whole.floquet->multipliers[k]), 0, 1e-7);
}

/// A condition between coordinates leaves two points of the circle: the one near the guess is the end.
TEST_F(Scenes, AnEndThatAConditionAndConstraintsDetermine) {
  const auto scene = [](const std::string& condition, const std::string& solve = "") {
    return "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - 9.81*y\"\n"
           "constraints = [\"x^2 + y^2 = 1\"]\n[boundary]\n"
           "conditions = [\"x(0) = 0.6\", \"y(0) = -0.8\", \"" +
           condition + "\"]\nduration = 0.7\n[guess]\nx = \"0.6 - 0.8*t/T\"\ny = \"-0.8 - 0.17*t/T\"\n" +
           solve;
  };
  for (const std::string solve : {"", "[solve]\nscheme = \"midpoint\"\nelements = 20\n"}) {
    const Solution found = run(study(scene("x(T) + y(T) = -1.1", solve)));
    ASSERT_TRUE(found.converged()) << found.message;
    const std::vector<double>& nodes = found.trajectory.nodes;
    const double x = nodes[nodes.size() - 2], y = nodes[nodes.size() - 1];
    EXPECT_NEAR(x, (-1.1 + std::sqrt(0.79)) / 2, 1e-14);
    EXPECT_NEAR(y, (-1.1 - std::sqrt(0.79)) / 2, 1e-14);
  }
  const std::string none =
      "no point near the guess satisfies both the constraints and what is given at the end";
  for (const char* condition : {"x(T) + y(T) = -3", "x(T) = 2*y(T) + 5"})
    EXPECT_NE(message(scene(condition)).find(none), std::string::npos) << message(scene(condition));
}

TEST_F(Scenes, AnEndThatIsFixedInOneOfThreeCoordinates) {
  const std::string what = message(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\n"
      "start = { x = 1, y = 0, z = 0 }\nend = { x = 0.5 }\nduration = 1.0\n"
      "[guess]\nx = \"1 - 0.5*t\"\ny = \"t\"\nz = \"0.1*t\"\n");
  EXPECT_NE(what.find("this end is fixed in part"), std::string::npos) << what;
}

TEST_F(Scenes, ADurationThatWhereDoesNotDetermine) {
  const std::string what = message(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 0 }\n"
      "end = { x = 1 }\nduration = \"free\"\nwhere = \"x(T) - x(0) = 1\"\n[guess]\nduration = 2\n");
  EXPECT_NE(what.find("'where' names ends that are fixed, so it does not determine the duration"),
            std::string::npos)
      << what;
}
