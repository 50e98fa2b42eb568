#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "problem/extension.hpp"
#include "scenes.hpp"
#include "solution/extension_values.hpp"
#include "study/continued.hpp"

using namespace extremal;
using namespace extremal::test;

/// \file Integrals, unknown constants, nonlinear conditions and waypoints, against values known in closed
/// form.

namespace {

using std::numbers::pi;

std::string system(const std::string& coordinates, const std::string& lagrangian,
                   const std::string& more = "") {
  return "[system]\ncoordinates = " + coordinates + "\nlagrangian = \"" + lagrangian + "\"\n" + more;
}

double at(const Solution& s, double t, int a) {
  const std::size_t n = s.trajectory.coordinates;
  std::vector<double> q(n), v(n);
  s.trajectory.at(t, q, v);
  return q[a];
}

double slope(const Solution& s, double t) {
  std::vector<double> q(1), v(1);
  s.trajectory.at(t, q, v);
  return v[0];
}

}  // namespace

TEST_F(Scenes, HangingChain) {
  const Solution s = run(study(system("[\"y\"]", "y*sqrt(1 + y'^2)") +
                               "[boundary]\nstart = { y = 1 }\nend = { y = 3 }\nduration = 1\n"
                               "integrals = [\"sqrt(1 + y'^2) = 4\"]\n[solve]\ntolerance = 1e-11\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, 5.0684801110, 1e-9);
  ASSERT_EQ(s.extension->integral_multipliers.size(), 1u);
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_TRUE(s.minimizing);
}

/// The largest area under a curve of given length is bounded by an arc of a circle.
TEST_F(Scenes, DidosArc) {
  const double angle = 1.1, radius = 1 / std::sin(angle);  // half of the chord is 1
  const std::string length = std::to_string(2 * angle * radius);
  const Solution s = run(study(system("[\"y\"]", "y") +
                               "[boundary]\nstart = { y = 0 }\nend = { y = 0 }\nduration = 2\nintegrals = "
                               "[\"sqrt(1 + y'^2) = " +
                               length + "\"]\n[guess]\ny = \"0.6*t*(2 - t)\"\n[solve]\ntolerance = 1e-11\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  // The length is rounded to six digits: the radius follows from the multiplier, which is −R.
  const double r = -s.extension->integral_multipliers[0];
  EXPECT_NEAR(std::abs(r), radius, 1e-5);
  EXPECT_NEAR(at(s, 1, 0), r - std::sqrt(r * r - 1), 1e-9);
}

TEST_F(Scenes, SturmLiouville) {
  const Solution s =
      run(study(system("[\"y\"]", "y'^2") + "[boundary]\nstart = { y = 0 }\nend = { y = 0 }\nduration = 1\n"
                                            "integrals = [\"y^2 = 1\"]\n[guess]\ny = \"1.3*sin(2*pi*t)\"\n"
                                            "[solve]\ntolerance = 1e-11\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, 4 * pi * pi, 1e-8);
  EXPECT_NEAR(s.extension->integral_multipliers[0], -4 * pi * pi, 1e-8);
  EXPECT_EQ(s.morse_index, 1);  // the first eigenfunction
  EXPECT_EQ(s.nullity, 0);
}

TEST_F(Scenes, CharacteristicValueOfMathieu) {
  const std::string scene =
      system("[\"x\"]", "x'^2/2 - (a - 2*q*cos(2*t))*x^2/2", "parameters = { q = 1, a = 0 }\n") +
      "[boundary]\nduration = \"pi\"\nunknowns = { a = -0.4 }\nwhere = [\"x(0) = 0.1\"]\n"
      "[guess]\nx = 0.1\n[solve]\ntolerance = 1e-11\n";
  const Solution s = run(study(scene));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->unknowns[0].second, -0.455138604107414, 1e-9);
  EXPECT_NEAR(at(s, 0, 0), 0.1, 1e-14);
}

/// A unit of mass that reaches a circle in a given time moves along its radius.
TEST_F(Scenes, CurvedEnd) {
  const Solution s =
      run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2") +
                "[boundary]\nconditions = [\"x(0) = 3\", \"y(0) = 4\", \"x(T)^2 + y(T)^2 = 4\"]\n"
                "duration = 1\n[guess]\nx = \"3 - 2*t\"\ny = \"4 - 2*t\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(at(s, 1, 0), 1.2, 1e-12);
  EXPECT_NEAR(at(s, 1, 1), 1.6, 1e-12);
  EXPECT_NEAR(s.action, 4.5, 1e-12);
  EXPECT_EQ(s.morse_index, 0);
}

/// The farthest point of the circle: no minimum across it.
TEST_F(Scenes, CurvedEndBeyond) {
  const Solution s =
      run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2") +
                "[boundary]\nconditions = [\"x(0) = 3\", \"y(0) = 4\", \"x(T)^2 + y(T)^2 = 4\"]\n"
                "duration = 1\n[guess]\nx = \"3 - 4*t\"\ny = \"4 - 5.5*t\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(at(s, 1, 0), -1.2, 1e-12);
  EXPECT_EQ(s.morse_index, 1);
}

TEST_F(Scenes, ReflectionAtALine) {
  const Solution s = run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2") +
                               "[boundary]\nstart = { x = 0, y = 1 }\nend = { x = 3, y = 2 }\nduration = 2\n"
                               "[[waypoints]]\nat = \"free\"\ny = 0\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  const WaypointImpulse& w = s.extension->waypoints.at(0);
  EXPECT_NEAR(w.time, 2.0 / 3, 1e-12);
  EXPECT_NEAR(at(s, w.time, 0), 1, 1e-12);
  EXPECT_EQ(w.impulse.size(), 1u);
  EXPECT_NEAR(w.impulse[0].second, 3, 1e-12);  // p_y from −3/2 to 3/2
  ASSERT_EQ(s.windows.size(), 2u);
  EXPECT_EQ(s.windows[0][1], w.time);
}

/// From the ground to the ground through the height 1: S(t) = 1/(2t) + 1/(2(2 − t)) − g − g²(t³ + (2 −
/// t)³)/24 has a maximum at t = 1, though the path there is a minimiser between its points.
TEST_F(Scenes, TheIndexCountsTheTimeOfAWaypoint) {
  const Study free = study(system("[\"x\"]", "x'^2/2 - g*x", "parameters = { g = 9.81 }\n") +
                           "[boundary]\nstart = { x = 0 }\nend = { x = 0 }\nduration = 2\n"
                           "[[waypoints]]\nat = \"free\"\nx = 1\n");
  const Solution s = run(free);
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->waypoints.at(0).time, 1, 1e-9);
  EXPECT_EQ(s.morse_index, 1);
  EXPECT_EQ(s.nullity, 0);
  EXPECT_FALSE(s.minimizing);
}

/// Two oscillators through a point at a free time: S(t) is a sum of four actions between points, and S' has
/// nine zeros, two of which are 0.17 apart.
TEST_F(Scenes, AllTimesOfAWaypoint) {
  const Study asked =
      study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - x^2/2 - 1.3^2*y^2/2") +
            "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = -0.3, y = 0.7 }\nduration = 7\n"
            "[[waypoints]]\nat = \"free\"\nx = 0.8\ny = 0.5\n[search]\nsolutions = 9\n");
  std::vector<double> times;
  for (const Solution& s : run_all(asked)) {
    ASSERT_TRUE(s.converged()) << s.message;
    times.push_back(s.extension->waypoints.at(0).time);
  }
  std::ranges::sort(times);
  const std::vector<double> expected = {0.1551, 1.6562, 2.0634, 2.2297, 3.6920,
                                        4.7593, 5.0239, 6.1141, 6.3986};
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], expected[k], 1e-4);
}

/// A waypoint that is given parts the action into those of two legs.
TEST_F(Scenes, LegsAreSearchedByThemselves) {
  const auto between = [](double start, double end, double duration, const std::string& rest) {
    return system("[\"x\"]", "x'^2/2 + x^2/2 - x^4/4") +
           fmt::format(
               "[boundary]\nstart = {{ x = {} }}\nend = {{ x = {} }}\nduration = {}\n{}[search]\n"
               "solutions = 12\n",
               start, end, duration, rest);
  };
  const std::vector<Solution> first = run_all(study(between(0.5, 0.8, 4, ""))),
                              second = run_all(study(between(0.8, -0.3, 5, "")));
  std::vector<double> sums;
  for (const Solution& a : first)
    for (const Solution& b : second) sums.push_back(a.action + b.action);
  std::ranges::sort(sums);
  const std::vector<Solution> found =
      run_all(study(between(0.5, -0.3, 9, "[[waypoints]]\nat = 4.0\nx = 0.8\n")));
  ASSERT_EQ(found.size(), 12u) << found.front().message;
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k].action, sums[k], 1e-8) << k;
}

TEST_F(Scenes, WaypointsAtGivenTimes) {
  const Study three = study(system("[\"x\"]", "x'^2/2 - x^2/2") +
                            "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 3\n"
                            "[[waypoints]]\nat = 1\nx = 0.5\n[[waypoints]]\nat = \"2\"\nx = 0.2\n");
  const Solution s = run(three);
  ASSERT_TRUE(s.converged()) << s.message;
  const auto slope = [](double from, double to, bool at_end) {
    return at_end ? (to * std::cos(1) - from) / std::sin(1) : (to - from * std::cos(1)) / std::sin(1);
  };
  EXPECT_NEAR(s.extension->waypoints[0].impulse[0].second, slope(0.5, 0.2, false) - slope(0, 0.5, true),
              1e-10);
  EXPECT_NEAR(s.extension->waypoints[1].impulse[0].second, slope(0.2, 1, false) - slope(0.5, 0.2, true),
              1e-10);
  EXPECT_NEAR(at(s, 1, 0), 0.5, 1e-14);
  EXPECT_EQ(s.windows.size(), 3u);
}

/// A waypoint that fixes every coordinate parts the legs, each of which is then solved by itself. The
/// velocity after it is that which shooting finds.
TEST_F(Scenes, LegsOfWhichOneHasNoEasyGuess) {
  const Solution s =
      run(study("[system]\ncoordinates = [\"q[3]\"]\n"
                "lagrangian = \"sum(i, 1, 3, q[i]'^2/2) - sum(i, 1, 2, (q[i+1] - q[i])^4/4)\"\n"
                "[boundary]\nstart = { q = [0, 1, 2] }\nend = { q = \"i^2/3\" }\nduration = 2\n"
                "[[waypoints]]\nat = 1\n\"q[2]\" = 2.0\n[[waypoints]]\nat = 1.5\nq = \"0.5*i\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  std::vector<double> q(3), v(3);
  s.trajectory.at(1.5, q, v);
  EXPECT_NEAR(v[0], -0.40723, 5e-6);
  EXPECT_NEAR(v[1], 0.45745, 5e-6);
  EXPECT_NEAR(v[2], 3.28311, 5e-6);
}

/// From a line, on which the length is stationary, Newton's method leads nowhere; no chain is shorter than
/// it.
TEST_F(Scenes, ChainsThatAreTooShort) {
  const Solution s = run(study(system("[\"y\"]", "y*sqrt(1 + y'^2)") +
                               "[boundary]\nstart = { y = 1 }\nend = { y = 3 }\nduration = 1\n"
                               "integrals = [\"sqrt(1 + y'^2) = 2\"]\n[solve]\nbudget = 20\n"));
  EXPECT_FALSE(s.converged());
  EXPECT_NE(s.message.find("another guess of the path"), std::string::npos);
}

/// The elements of a scheme converge with its order.
TEST_F(Scenes, IntegralsWithAScheme) {
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const Solution s =
        run(study(system("[\"y\"]", "y'^2") + "[boundary]\nstart = { y = 0 }\nend = { y = 0 }\nduration = 1\n"
                                              "integrals = [\"y^2 = 1\"]\n[guess]\ny = \"1.3*sin(pi*t)\"\n"
                                              "[solve]\nscheme = \"midpoint\"\n",
                  {"solve.elements=" + std::to_string(32 << k)}));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_TRUE(s.pinned);
    error[k] = s.action - pi * pi;
  }
  EXPECT_NEAR(error[0] / error[1], 4, 0.05);
}

/// The length of a pendulum of given period and amplitude: T = 4 sqrt(l/g) K(sin(1/2)).
TEST_F(Scenes, UnknownOfAPeriodicOrbit) {
  const Solution s =
      run(study(system("[\"q\"]", "l^2*q'^2/2 + g*l*cos(q)", "parameters = { g = 9.81, l = 1 }\n") +
                "[boundary]\nperiodic = true\nduration = 2\nunknowns = { l = 0.9 }\n"
                "where = [\"q(0) = 1\"]\n[guess]\nq = \"cos(pi*t)\"\n"
                "[solve]\ntolerance = 1e-12\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  const double k = std::comp_ellint_1(std::sin(0.5));
  EXPECT_NEAR(s.extension->unknowns[0].second, 9.81 / (4 * k * k), 1e-10);
  ASSERT_TRUE(s.floquet.has_value());
  EXPECT_EQ(s.floquet->trivial_pairs, 1);
}

/// The constant u = √(1/2) satisfies the equations too, but a pulse is asked for.
TEST_F(Scenes, AnOrbitWithAnIntegralDoesNotShrinkToRest) {
  const Solution s = run(study(system("[\"u\"]", "u'^2/2 - u^4/4") +
                               "[boundary]\nperiodic = true\nduration = 6\nintegrals = [\"u^2 = 3\"]\n"
                               "[guess]\nu = \"1/cosh(t - T/2)\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  const auto [least, most] = std::ranges::minmax(s.trajectory.nodes);
  EXPECT_GT(most - least, 0.1);
  EXPECT_LT(*s.energy_drift, 1e-7);
}

/// All of Kepler's orbits of one axis have one period: of a continuum that near the guess.
TEST_F(Scenes, UnknownOfAContinuumOfOrbits) {
  const Solution s = run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 + mu/sqrt(x^2 + y^2)") +
                               "[boundary]\nperiodic = true\nduration = 4\nunknowns = { mu = 2.2 }\n"
                               "where = [\"x(0)^2 + y(0)^2 = 1\"]\n"
                               "[guess]\nx = \"1.02*cos(pi*t/2)\"\ny = \"1.02*sin(pi*t/2)\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->unknowns[0].second, pi * pi / 4, 0.2);
  EXPECT_EQ(s.morse_index, 0);
}

/// A loop in the potential -1/r, which begins anywhere: the energy is the same on all legs. So it is in the
/// isotropic oscillator, where that of a leg from a to b in τ is (a² + b² − 2 a·b cos τ)/(2 sin² τ).
TEST_F(Scenes, LoopsThroughPointsAtFreeTimes) {
  const double a[3][2] = {{1.2, 0}, {0, 0.9}, {-1, -0.5}};
  const auto loop = [&](const std::string& potential, double T) {
    std::string points;
    for (const auto& point : a)
      points += fmt::format("[[waypoints]]\nat = \"free\"\nx = {}\ny = {}\n", point[0], point[1]);
    return run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - " + potential) +
                     fmt::format("[boundary]\nperiodic = true\nduration = {}\n", T) + points +
                     "[guess]\nx = \"cos(2*pi*t/T)\"\ny = \"sin(2*pi*t/T)\"\n"));
  };
  for (const double T : {4.0, 5.0, 6.0, 7.0}) {
    const Solution s = loop("-1/sqrt(x^2 + y^2)", T);
    ASSERT_TRUE(s.converged()) << T << ' ' << s.message;
    EXPECT_LT(s.energy_drift.value(), 1e-7) << T;
  }
  for (const double T : {4.0, 5.0}) {
    const Solution s = loop("(x^2 + y^2)/2", T);
    ASSERT_TRUE(s.converged()) << T << ' ' << s.message;
    const std::vector<WaypointImpulse>& at = s.extension->waypoints;
    for (int k = 0; k < 3; ++k) {
      const double *from = a[k], *to = a[(k + 1) % 3];
      const double tau = k < 2 ? at[k + 1].time - at[k].time : T - at[2].time + at[0].time;
      const double squares = from[0] * from[0] + from[1] * from[1] + to[0] * to[0] + to[1] * to[1];
      const double product = from[0] * to[0] + from[1] * to[1];
      EXPECT_NEAR((squares / 2 - product * std::cos(tau)) / std::pow(std::sin(tau), 2), s.energy.value(),
                  1e-7)
          << T << ' ' << k;
    }
  }
}

/// With a free duration one condition more; an end made of an unknown.
TEST_F(Scenes, UnknownWithAFreeDuration) {
  const Solution s =
      run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - g*y", "parameters = { g = 1 }\n") +
                "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = \"2*u\", y = 0 }\n"
                "duration = \"free\"\nenergy = 2\nunknowns = { u = 1.5 }\n"
                "where = [\"u = 1.2\"]\n[guess]\nduration = 2\nx = \"t\"\ny = \"t*(2 - t)\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->unknowns[0].second, 1.2, 1e-12);
  EXPECT_NEAR(at(s, s.duration(), 0), 2.4, 1e-11);
  EXPECT_NEAR(*s.energy, 2, 1e-10);
}

TEST_F(Scenes, ExtensionsThatAreRefused) {
  const std::string free = system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2");  // lines 1 to 3
  const std::string fixed = "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 1, y = 1 }\nduration = 2\n";
  EXPECT_EQ(message(free + fixed + "[[waypoints]]\nx = 1\n"),
            "scene.toml:8:1: this waypoint has no 'at'; give its time, or at = \"free\"");
  EXPECT_EQ(message(free + fixed + "[[waypoints]]\nat = 1\n"),
            "scene.toml:8:1: this waypoint fixes no coordinate; name one, x = 0.2");
  EXPECT_EQ(message(free + fixed + "[[waypoints]]\nat = 2.5\nx = 1\n"),
            "scene.toml:9:6: at = 2.5; a waypoint lies between 0 and T = 2");
  EXPECT_EQ(
      message(free + fixed + "[[waypoints]]\nat = 1\nx = 1\n[[waypoints]]\nat = 1\nx = 2\n"),
      "scene.toml:12:6: at = 1 is not after the waypoint before, at 1; write waypoints in order of their "
      "times");
  EXPECT_EQ(
      message(free + fixed + "integrals = [\"x\"]\n").rfind("scene.toml:8:15: an integral is an equation", 0),
      0u);
  EXPECT_EQ(message(free + fixed + "integrals = [\"x'*zz = 1\"]\n").rfind("scene.toml:8:18: ", 0), 0u);
  EXPECT_EQ(
      message(free + fixed + "unknowns = { k = 1 }\n"),
      "scene.toml:8:14: 'where' has 0 equations, and 1 number is to be determined: the unknowns; give as "
      "many equations, between end values that are not fixed");
  EXPECT_EQ(
      message(free + fixed + "unknowns = { k = 1 }\nwhere = [\"x(0) = 1\", \"x(T) = 1\"]\n"),
      "scene.toml:9:10: 'where' has 2 equations, and 1 number is to be determined: the unknowns; give as "
      "many equations, or more unknowns");
  EXPECT_EQ(message(free + "[boundary]\nconditions = [\"x(0)^2 = 1\", \"y(0) = 0\"]\nduration = 1\n"
                           "[continuation]\nparameter = \"duration\"\nto = 2\nswitch = true\n")
                .rfind("scene.toml:8:14: ", 0),
            0u);
}

/// Rotations about the origin keep both circles: nothing else leaves the action as it is.
TEST_F(Scenes, FamilyThatASymmetryMakes) {
  const Solution s =
      run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - (x^2 + y^2)/2") +
                "[boundary]\nconditions = [\"x(0)^2 + y(0)^2 = 1\", \"x(T)^2 + y(T)^2 = 2.25\"]\n"
                "duration = 1\n[guess]\nx = \"1 + 0.5*t\"\ny = \"0.1*t\"\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_EQ(s.nullity, 1);
  EXPECT_TRUE(s.minimizing);
  EXPECT_NE(s.message.find("one of a family of extremals, which symmetries"), std::string::npos) << s.message;
}

/// A chain hangs, or stands as an arch: y and −y + const of one multiplier, with energies of opposite signs.
TEST_F(Scenes, BothCatenariesAreFound) {
  const Study s = study(system("[\"y\"]", "y*sqrt(1 + y'^2)") +
                        "[boundary]\nstart = { y = 1 }\nend = { y = 3 }\nduration = 1\n"
                        "integrals = [\"sqrt(1 + y'^2) = 4\"]\n[search]\nsolutions = 2\n");
  const std::vector<Solution> found = run_all(s);
  ASSERT_EQ(found.size(), 2u) << found.front().message;
  EXPECT_NEAR(found[0].action, 5.0684801110, 1e-8);
  // Reflection at the height 2 of the middle takes one to the other: actions add up to 2·2·4.
  EXPECT_NEAR(found[0].action + found[1].action, 16, 1e-8);
  EXPECT_NEAR(*found[0].energy + *found[1].energy, 0, 1e-8);
}

/// Orbits through a point at a given time may go round the centre on either side before and after it.
TEST_F(Scenes, ToursThroughAPointDiffer) {
  const Study s = study(
      "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1.0, y = 0.0 }\n"
      "end = { x = -1.2, y = 0.3 }\nduration = 7.0\n[[waypoints]]\nat = 3.0\nx = -0.5\n"
      "y = 0.8\n[search]\nsolutions = 40\n");
  const std::vector<Solution> found = run_all(s);
  ASSERT_GE(found.size(), 2u) << found.front().message;
  EXPECT_NE(found.front().message.find("more may exist"), std::string::npos);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(found[i].converged());
    EXPECT_NEAR(at(found[i], 3, 0), -0.5, 1e-9);
    EXPECT_NEAR(at(found[i], 3, 1), 0.8, 1e-9);
    if (i > 0) {
      EXPECT_GT(found[i].action, found[i - 1].action + 1e-6);
    }
  }
}

/// Ellipses of the period 6 have μ = a³(π/3)²; those with x(0) = 1.1 have any a > 0.55.
TEST_F(Scenes, ConstantsOfAContinuumAreTold) {
  const std::string ellipses =
      system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 + mu/sqrt(x^2 + y^2)", "parameters = { mu = 1.0 }\n") +
      "[boundary]\nperiodic = true\nduration = 6.0\nunknowns = { mu = 1.0 }\nwhere = [\"x(0) = 1.1\"]\n"
      "[guess]\nx = \"1.1*cos(2*pi*t/T)\"\ny = \"sin(2*pi*t/T)\"\n";
  const Solution found = run(study(ellipses));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NE(found.message.find("they do not determine 'mu'"), std::string::npos) << found.message;
}

/// From x = 0 an oscillator is at 0 again after π: another waypoint there has no extremal, whatever the other
/// leg is; 0 has one for every velocity on each leg, of which those of the guess are kept.
TEST_F(Scenes, LegsWithConjugateEnds) {
  const auto through = [&](const std::string& at_pi, const std::string& end, const std::string& duration) {
    return run(study(system("[\"x\"]", "x'^2/2 - x^2/2") +
                         "[boundary]\nstart = { x = 0 }\nend = { x = " + end + " }\nduration = \"" +
                         duration + "\"\n[[waypoints]]\nat = \"pi\"\nx = " + at_pi +
                         "\n[guess]\nx = \"0.5*sin(t) + x_end*t/T\"\n",
                     {"system.parameters.x_end=" + end}));
  };
  for (const auto& [end, duration] : {std::pair{"0", "2*pi"}, {"0.3", "7"}}) {
    const Solution none = through("0.5", end, duration);
    EXPECT_EQ(none.status, Status::conjugate_ends) << none.message;
    EXPECT_LT(none.iterations, 200);
  }
  const Solution both = through("0", "0", "2*pi");
  ASSERT_TRUE(both.converged()) << both.message;
  EXPECT_EQ(both.nullity, 2);
  EXPECT_NEAR(at(both, pi / 2, 0), 0.5, 1e-9);
  EXPECT_NE(both.message.find("one of a family of extremals, in 2 directions"), std::string::npos)
      << both.message;
}

/// Two circles and x(0) = x(T)/3 are met by ends at angles θ(T) = ±θ(0). These curves cross at θ = 0, where
/// the three gradients depend on each other and p is not normal to either curve. By S = d²/2 − (y(0) +
/// y(T))/2 − 1/24 for the distance d of the ends, dS/dθ vanishes at sin θ(0) = −1/12 on one, S = 23/12, and
/// at θ = ±π/2 on the other, S = −1/24 or 95/24; both ends of a diameter, θ = ±π/2, have d = 4, S = 8 − 1/24
/// ± 1.
TEST_F(Scenes, CurvesOfEndsThatCross) {
  const std::string crossing =
      system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - y") +
      "[boundary]\nconditions = [\"x(0)^2 + y(0)^2 = 1\", \"x(T)^2 + y(T)^2 = 9\", \"x(0) = x(T)/3\"]\n"
      "duration = 1\n[guess]\n";
  for (const char* guess :
       {"x = \"1 + 2*t\"\ny = 0.2\n", "x = \"1 + 2*t\"\ny = 0.02\n", "x = \"1 + 2*t\"\ny = \"-0.1*t\"\n"}) {
    const Solution s = run(study(crossing + guess));
    ASSERT_TRUE(s.converged()) << s.message;
    double nearest = INFINITY;
    for (const double action : {23 / 12.0, -1 / 24.0, 95 / 24.0, 167 / 24.0, 215 / 24.0})
      nearest = std::min(nearest, std::abs(s.action - action));
    EXPECT_LT(nearest, 1e-9) << guess << s.action;
  }
}

/// From one top of a pendulum over the next, with the bottom at t = 16: a kink 4 atan e^(t − 16) − π but for
/// e^−32, of action 8 − T, which passes there by itself. Newton's method from straight lines does not arrive.
TEST_F(Scenes, KinkThroughAWaypoint) {
  const Solution s = run(study(system("[\"x\"]", "x'^2/2 + cos(x)") +
                               "[boundary]\nstart = { x = \"-pi\" }\nend = { x = \"pi\" }\nduration = 40\n"
                               "[[waypoints]]\nat = 16\nx = 0\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, 8 - 40, 1e-11);
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_NEAR(at(s, 17, 0), 4 * std::atan(std::numbers::e) - pi, 1e-8);
  EXPECT_NEAR(s.extension->waypoints[0].impulse[0].second, 0, 1e-9);
}

/// Times are fixed and the potential is bounded, so there is a path of least action.
TEST_F(Scenes, LeastActionThroughWaypoints) {
  const Solution s =
      run(study(system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - 2*(cos(3*x) + cos(2*y) + 0.3*cos(x*y))") +
                "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 4, y = -3 }\nduration = 6\n"
                "[[waypoints]]\nat = 2\nx = 1\n[[waypoints]]\nat = 4\nx = 2.5\ny = 2\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_TRUE(s.minimizing);
}

/// x'' = −y, y'' = −x: x + y is trigonometric, x − y hyperbolic, and so are the momenta of the ends that
/// conditions ask for.
TEST_F(Scenes, MomentaGivenByUnknowns) {
  const std::string law = "parameters = { A = 1, B = 0.3 }\n[boundary]\nduration = 1\n";
  const std::string two = system("[\"x\", \"y\"]", "(x'^2 + y'^2)/2 - x*y", law);
  const double sum = (1.5 - 1.7 * std::cos(1)) / std::sin(1),
               difference = (0.5 - 0.7 * std::cosh(1)) / std::sinh(1);
  const Solution s =
      run(study(two + "start = { p_x = \"A\", p_y = \"A*B\" }\nend = { x = 1, y = 0.5 }\n"
                      "unknowns = { A = 1, B = 0.3 }\nwhere = [\"x(0) = 1.2\", \"y(0) = 0.5\"]\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->unknowns[0].second, (sum + difference) / 2, 1e-12);
  EXPECT_NEAR(s.extension->unknowns[1].second, (sum - difference) / (sum + difference), 1e-11);
  EXPECT_NEAR(s.momentum_start[0], (sum + difference) / 2, 1e-12);
  const double sum_end = (1.5 * std::cos(1) - 1.7) / std::sin(1),
               difference_end = (0.5 * std::cosh(1) - 0.7) / std::sinh(1);
  const Solution end = run(study(two + "start = { x = 1.2, y = 0.5 }\nend = { p_x = \"2*A*B\", y = 0.5 }\n"
                                       "unknowns = { A = 1 }\nwhere = [\"x(T) = 1\"]\n"));
  ASSERT_TRUE(end.converged()) << end.message;
  EXPECT_NEAR(end.extension->unknowns[0].second, (sum_end + difference_end) / 1.2, 1e-11);
  const std::string both = "unknowns = { A = 1 }\nwhere = [\"y(T) = 1\"]\n";
  EXPECT_EQ(
      message(two + "start = { x = 1.2, p_x = \"A*B\" }\n" + both),
      "scene.toml:7:26: 'p_x' depends on an unknown, and 'x' is given at this end too; leave one of them "
      "out");
  EXPECT_EQ(
      message(two + "start = { x = \"A*B\", p_x = 1 }\n" + both),
      "scene.toml:7:15: 'x' depends on an unknown, and 'p_x' is given at this end too; leave one of them "
      "out");
}

/// Each point of a family has its own unknowns and impulses. x = ½ sin(wt)/sin w before the first waypoint;
/// a cos(k(1 − t))/cos k with cos k = a/1.7; a chain of the length l, sinh(u)/u = √(l² − 4), u = 1/2c, with
/// y' = sinh((t − t0)/c).
TEST_F(Scenes, FamiliesOfExtendedProblems) {
  const auto last = [&](const std::string& scene) {
    const FollowedBranch branch = follow(study(scene));
    EXPECT_EQ(branch.branches[0].end, BranchEnd::target) << branch.branches[0].message;
    return branch.points.back().solution;
  };
  const Solution between =
      last(system("[\"x\"]", "x'^2/2 - w^2*x^2/2", "parameters = { w = 1 }\n") +
           "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 3\n[[waypoints]]\nat = 1\nx = 0.5\n"
           "[[waypoints]]\nat = 2\nx = -0.25\n[continuation]\nparameter = \"w\"\nto = 2.5\npoints = 8\n");
  const double w = 2.5, after = w * (-0.25 - 0.5 * std::cos(w)) / std::sin(w);
  EXPECT_NEAR(between.momentum_start[0], 0.5 * w / std::sin(w), 1e-9);
  EXPECT_NEAR(between.extension->waypoints[0].impulse[0].second, after - 0.5 * w / std::tan(w), 1e-8);
  const Solution unknown =
      last(system("[\"x\"]", "x'^2/2 - k^2*x^2/2", "parameters = { a = 1.5, k = 0.5 }\n") +
           "[boundary]\nstart = { x = \"a\" }\nduration = 1\nunknowns = { k = 0.5 }\n"
           "where = [\"x(T) = 1.7\"]\n[continuation]\nparameter = \"a\"\nto = 0.3\npoints = 8\n");
  EXPECT_NEAR(unknown.extension->unknowns[0].second, std::acos(0.3 / 1.7), 1e-9);
  const Solution chain =
      last(system("[\"y\"]", "y*sqrt(1 + y'^2)", "parameters = { l = 4 }\n") +
           "[boundary]\nstart = { y = 1 }\nend = { y = 3 }\nduration = 1\n"
           "integrals = [\"sqrt(1 + y'^2) = l\"]\n[continuation]\nparameter = \"l\"\nto = 3\npoints = 4\n");
  double u = 2;
  for (int k = 0; k < 20; ++k) u -= (std::sinh(u) - std::sqrt(5) * u) / (std::cosh(u) - std::sqrt(5));
  EXPECT_NEAR(std::asinh(slope(chain, 1)) - std::asinh(slope(chain, 0)), 2 * u, 1e-8);
}

/// Two oscillators of frequencies 1 and √2 that start on the unit circle, at an angle θ, and end at a point:
/// the action S(θ) of what is between is known, and extremals are where its derivative is zero. There are two
/// or four, all of which a search finds, from whichever the shortest line leads to.
TEST_F(Scenes, AllExtremalsThatStartOnACircle) {
  constexpr double T = 0.64;
  constexpr double ends[][2] = {{-5.11, 0.84}, {-0.91, -0.43}, {0.45, -0.71}, {-0.4, 0.05}, {0.96, -0.48}};
  for (const auto& end : ends) {
    const double x = end[0], y = end[1];
    const auto part = [](double w, double start, double end) {
      return w / (2 * std::sin(w * T)) * ((start * start + end * end) * std::cos(w * T) - 2 * start * end);
    };
    const auto action = [&](double angle) {
      return part(1, std::cos(angle), x) + part(std::numbers::sqrt2, std::sin(angle), y);
    };
    std::vector<double> expected;
    constexpr int steps = 20000;
    const auto at = [&](int k) { return action(2 * std::numbers::pi * k / steps); };
    for (int k = 0; k < steps; ++k)
      if ((at(k) - at(k - 1)) * (at(k + 1) - at(k)) <= 0) expected.push_back(at(k));
    std::ranges::sort(expected);
    const std::vector<Solution> found = run_all(study(fmt::format(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - x^2/2 - "
        "y^2\"\n[boundary]\nconditions = [\"x(0)^2 + y(0)^2 = 1\", \"x(T) = {}\", \"y(T) = {}\"]\n"
        "duration = {}\n[search]\nsolutions = 6\n",
        x, y, T)));
    ASSERT_EQ(found.size(), expected.size()) << x;
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k].action, expected[k], 1e-5) << x;
  }
}

/// A free waypoint that is the start is passed at t = 0, where it is none.
TEST_F(Scenes, PointsThatAreOneAreTold) {
  const Solution found = run(
      study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n[boundary]\nstart = { "
            "x = 0, "
            "y = 0 }\nend = { x = 1, y = 0 }\nduration = 1\n[[waypoints]]\nat = \"free\"\nx = 0\ny = 0\n"));
  EXPECT_FALSE(found.converged());
  EXPECT_NE(found.message.find("waypoint 1 is where the start is"), std::string::npos) << found.message;
}

/// What is held and the action have units of their own, which no index depends on.
TEST_F(Scenes, AnIndexDoesNotDependOnTheUnitOfTheAction) {
  for (const double m : {1e-10, 1e-8, 1e-6, 1.0, 1e4, 1e6, 1e9}) {
    const Solution integral =
        run(study(system("[\"u\"]", fmt::format("{}*u'^2/2", m)) +
                  "[boundary]\nstart = { u = 0 }\nend = { u = 0 }\nduration = 1\nintegrals = [\"u = 1\"]\n"));
    ASSERT_TRUE(integral.converged()) << m << integral.message;
    EXPECT_NEAR(integral.action, 6 * m, 1e-9 * m);
    const Solution condition = run(
        study(system("[\"x\", \"y\"]", fmt::format("{}*(x'^2 + y'^2)/2", m)) +
              "[boundary]\nconditions = [\"x(0)^2 + y(0)^2 = 1\", \"x(T) = 3\", \"y(T) = 0\"]\nduration = "
              "1\n[guess]\nx = \"1 + 2*t\"\ny = \"0.02*sin(pi*t)\"\n"));
    ASSERT_TRUE(condition.converged()) << m << condition.message;
    for (const Solution* s : {&integral, &condition}) {
      EXPECT_EQ(s->morse_index, 0) << m;
      EXPECT_EQ(s->nullity, 0) << m;
      EXPECT_TRUE(s->minimizing) << m;
    }
  }
}

/// A flat arc over a chord encloses most, with a large multiplier. The chord alone is no extremal: along it
/// the length does not change to first order.
TEST_F(Scenes, FlatArcsAndTheChord) {
  const auto arc = [&](double length) {
    return run(
        study(system("[\"y\"]", "-y") +
              fmt::format("[boundary]\nstart = {{ y = 0 }}\nend = {{ y = 0 }}\nduration = 1\nintegrals = "
                          "[\"sqrt(1 + y'^2) = {}\"]\n",
                          length)));
  };
  const Solution flat = arc(1 + 1e-7);
  ASSERT_TRUE(flat.converged()) << flat.message;
  EXPECT_EQ(flat.morse_index, 0);
  EXPECT_EQ(flat.nullity, 0);
  // y = h 4t(1 − t) has the length 1 + 8h²/3 and the area 2h/3, but for h⁴ and h³.
  EXPECT_NEAR(flat.action, -2.0 / 3 * std::sqrt(3e-7 / 8), 1e-9);
  const Solution chord = arc(1);
  EXPECT_FALSE(chord.converged());
  EXPECT_NE(chord.message.find("does not change with the path to first order"), std::string::npos)
      << chord.message;
}

/// Two integrals of an indefinite quadratic L, which roundoff of a path of large values alone leaves unmet.
TEST_F(Scenes, IntegralsOfLargePathsAreMetToRoundoff) {
  const Solution s = run(study(
      system("[\"a\", \"b\"]", "(a'^2 + b'^2)/2 + 0.13077175*a^2 + 0.59556794*a*b - 1.18340589*b^2") +
      "[boundary]\nstart = { a = -0.566 }\nend = { a = -0.598 }\nduration = 3.149743460239177\nintegrals = "
      "[\"cos(1.672*t)*(a + b) = 0.812\", \"cos(2.243*t)*b = -0.321\"]\n[[waypoints]]\nat = 0.932\n"
      "a = 0.993\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.extension->integral_multipliers[0], -322.2, 0.5);
  EXPECT_NEAR(s.extension->integral_multipliers[1], 281.8, 0.5);
}
