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

  // A scheme has the end as a condition between points of the sphere.
  for (const int elements : {8, 16}) {
    const std::string scheme = fmt::format("[solve]\nscheme = \"midpoint\"\nelements = {}\n", elements);
    const Solution discrete = run(study(sphere + guess + scheme));
    ASSERT_TRUE(discrete.converged()) << discrete.message;
    EXPECT_NEAR(discrete.action, angle.action, 0.008 / (elements * elements));
    EXPECT_EQ(discrete.morse_index, angle.morse_index);
  }
  if (!available(Method::ceres)) return;
  const std::string refusal =
      "this end is fixed in part, and constraints link what is fixed with what is free";
  EXPECT_NE(message(sphere + guess + "[solve]\nmethod = \"ceres\"\n").find(refusal), std::string::npos);
}

/// It swings up past the middle of the sphere, where x and y are no coordinates.
TEST_F(Scenes, APathThatLeavesItsChartIsFoundInAnother) {
  Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - 9.81*z\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = { x = 0.6, y = 0, z = -0.8 }\n"
      "end = { x = 0.3, y = 0.1, z = \"-sqrt(0.9)\" }\nduration = 1.2\n");
  const Manifold::Parts parts = s.problem.manifold->parts();
  ASSERT_TRUE(parts.minimal && parts.minimal->next);
  const auto solved_with = [&](std::shared_ptr<const MinimalProblem> minimal) {
    Manifold::Parts other = parts;
    other.only_minimal = minimal != nullptr;
    other.minimal = std::move(minimal);
    s.problem.manifold = std::make_shared<const Manifold>(std::move(other));
    return run(s);
  };
  MinimalProblem alone = *parts.minimal;
  alone.next = nullptr;
  EXPECT_FALSE(solved_with(std::make_shared<const MinimalProblem>(alone)).converged());
  const Solution in_charts = solved_with(parts.minimal), in_all = solved_with(nullptr);
  ASSERT_TRUE(in_charts.converged() && in_all.converged()) << in_charts.message;
  EXPECT_NEAR(in_charts.action, in_all.action, 1e-10);
  EXPECT_EQ(in_charts.morse_index, in_all.morse_index);
  std::vector<double> q(3), v(3);
  in_charts.trajectory.at(0.6, q, v);
  EXPECT_GT(q[2], 0.3);
}

/// What begins in a chart and leaves it is marched still, not sought between ends.
TEST_F(Scenes, AMotionThatLeavesItsChartIsMarched) {
  Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - 9.81*z\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nduration = 0.8\n"
      "start = { x = 0.6, y = 0, z = -0.8, p_x = 3.2, p_y = 1.5, p_z = 2.4 }\n");
  const Solution in_charts = run(s);
  Manifold::Parts parts = s.problem.manifold->parts();
  ASSERT_TRUE(parts.minimal && parts.minimal->next);
  parts.minimal = nullptr;
  s.problem.manifold = std::make_shared<const Manifold>(parts);
  const Solution in_all = run(s);
  ASSERT_TRUE(in_charts.converged() && in_all.converged()) << in_charts.message;
  EXPECT_NEAR(in_charts.action, in_all.action, 1e-8);
  EXPECT_NEAR(in_charts.momentum_start[0], 3.2, 1e-12);
  EXPECT_FALSE(in_charts.morse_index);
}

/// The guess ends elsewhere, where x is no coordinate of the sphere.
TEST_F(Scenes, AChartHasTheFixedEndsInPlaceOfThoseOfTheGuess) {
  const std::string duration = "duration = 0.8\n";
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
                "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = { z = -0.8 }\n"
                "end = { x = 0, y = 0.8, z = 0.6 }\n" +
                duration + "[guess]\nx = 0.4\ny = 0.3\nz = \"-0.8 + 1.4*t/T\"\n"));
  const Solution angle =
      run(study("[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + cos(a)\"\n[boundary]\n"
                "start = { a = \"acos(0.8)\" }\nend = { a = \"acos(-0.6)\" }\n" +
                duration));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message;
  EXPECT_NEAR(found.action, angle.action, 1e-10);
  EXPECT_EQ(found.morse_index, 0);
  std::vector<double> q(3), v(3);
  found.trajectory.at(0, q, v);
  EXPECT_NEAR(q[0], 0, 1e-9);
}

/// No two coordinates of the sphere include what is given at the start and at the end.
TEST_F(Scenes, EndsThatNoChartIncludesAreConditions) {
  const auto scene = [](const std::string& parallel, const std::string& oblique, const std::string& s) {
    return "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
           "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nconditions = [\"z(" +
           parallel + ") = -0.8\", \"0.8*x(" + oblique + ") + 0.6*z(" + oblique +
           ") = 0.6\"]\nduration = 1.0\n[guess]\nx = \"0.6 + 0.3*" + s + "\"\ny = 0.05\nz = \"-0.8 + 0.9*" +
           s + "\"\n";
  };
  for (const std::string& text : {scene("0", "T", "t"), scene("T", "0", "(1 - t)")}) {
    const Solution found = run(study(text));
    ASSERT_TRUE(found.converged()) << found.message;
    // Along the meridian between the circles.
    const double way = std::asin(0.6) - std::acos(0.6) + std::asin(0.8);
    EXPECT_NEAR(found.action, way * way / 2, 1e-11);
    EXPECT_EQ(found.morse_index, 0);
  }
}

/// Turned about the start, each arc is another one.
TEST_F(Scenes, AnEndThatIsFixedInOneOfThreeCoordinates) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
                "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\n"
                "start = { x = 1, y = 0, z = 0 }\nend = { x = 0.5 }\nduration = 1.0\n"
                "[guess]\nx = \"1 - 0.5*t\"\ny = \"t\"\nz = \"0.1*t\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, std::pow(std::acos(0.5), 2) / 2, 1e-11);
  EXPECT_EQ(found.morse_index, 0);
  EXPECT_EQ(found.nullity, 1);
}

TEST_F(Scenes, ADurationThatWhereDoesNotDetermine) {
  const std::string what = message(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 0 }\n"
      "end = { x = 1 }\nduration = \"free\"\nwhere = \"x(T) - x(0) = 1\"\n[guess]\nduration = 2\n");
  EXPECT_NE(what.find("'where' names ends that are fixed, so it does not determine the duration"),
            std::string::npos)
      << what;
}
