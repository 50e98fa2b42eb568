#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "problem/extension.hpp"
#include "scenes.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"

/// \file Closed paths with waypoints at free times: no time is the first one.

using namespace extremal;
using namespace extremal::test;

namespace {

using std::numbers::pi;

struct Point {
  double x, y;
};

std::string waypoint(const Point& p) {
  return fmt::format("[[waypoints]]\nat = \"free\"\nx = {:.17g}\ny = {:.17g}\n", p.x, p.y);
}

/// A free particle on a closed path; the guess is to follow.
std::string closed(const std::string& constraints, const std::string& duration) {
  return free_particle(constraints, "periodic = true\n" + duration);
}

const char* const round_a_disc = "\"x^2 + y^2 >= 1\"";
const char* const round_two_discs = "\"(x - 2)^2 + y^2 >= 1\", \"(x + 2)^2 + y^2 >= 1\"";
const std::string speed_one = "duration = \"free\"\nenergy = 0.5\n";

/// An ellipse whose angle is 2π t/T + at + faster sin(2π t/T + when).
std::string ellipse(double a, double b, double at, double faster = 0, double when = 0) {
  const std::string angle = fmt::format("2*pi*t/T + ({}) + ({})*sin(2*pi*t/T + ({}))", at, faster, when);
  return fmt::format("[guess]\nx = \"{}*cos({})\"\ny = \"{}*sin({})\"\n", a, angle, b, angle);
}

/// The shortest closed path round the unit disc through points, in the order of their angles.
double length_through(const std::vector<Point>& points) {
  double length = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point &p = points[k], &q = points[(k + 1) % points.size()];
    const double a = std::hypot(p.x, p.y), b = std::hypot(q.x, q.y);
    double angle = std::atan2(q.y, q.x) - std::atan2(p.y, p.x);
    if (angle <= 0) angle += 2 * pi;
    const double arc = angle - std::acos(1 / a) - std::acos(1 / b);
    length += arc > 0 ? arc + std::sqrt(a * a - 1) + std::sqrt(b * b - 1) : std::hypot(p.x - q.x, p.y - q.y);
  }
  return length;
}

class ClosedPaths : public UnderInequalities {};
class ClosedGuesses : public Scenes {};

}  // namespace

/// A band round two discs, drawn to (0, −3), at any time of the guess.
TEST_F(ClosedPaths, TheGuessMayBeginAnywhere) {
  const double r = std::sqrt(13.0), tangent = std::sqrt(r * r - 1);  // from a centre to the point
  const double arc = 3 * pi / 2 - std::atan2(3, 2) - std::acos(1 / r);
  const double length = 4 + 2 * tangent + 2 * arc;
  for (const double at : {-pi / 2, -2.0, 0.0, pi / 2}) {
    const Solution solution = found(closed(round_two_discs, speed_one) + ellipse(4, 2.5, at) +
                                    "duration = 12\n" + waypoint({0, -3}));
    EXPECT_NEAR(solution.duration(), length, 1e-8) << at;
    EXPECT_NEAR(solution.action, length / 2, 1e-8) << at;
  }
}

/// The guess passes the second point first: their order is that of a cycle.
TEST_F(ClosedPaths, TheFirstWaypointComesFirst) {
  const std::vector<Point> points{{0, 1.1}, {0, -1.1}};
  const double length = length_through(points);
  for (const double at : {0.0, pi / 2, 2.0, -pi / 2}) {
    const Solution solution = found(closed(round_a_disc, "duration = 2\n") + ellipse(1.3, 1.3, at) +
                                    waypoint(points[0]) + waypoint(points[1]));
    EXPECT_NEAR(solution.action, length * length / 4, 1e-8) << at;
    const std::vector<WaypointImpulse>& passed = solution.extension->waypoints;
    ASSERT_EQ(passed.size(), 2u);
    EXPECT_NEAR(passed[1].time - passed[0].time, 1, 1e-7) << at;
    EXPECT_LT(passed[0].impulse.at(1).second, 0) << at;
  }
}

/// The leg across the end of the path is much shorter than that of the guess.
TEST_F(ClosedPaths, TheLegAcrossTheEndStretches) {
  const std::vector<Point> points{{1.5, 0.6}, {-0.1, -1.6}, {0.4, -1.8}};
  const Solution solution =
      found(closed(round_a_disc, speed_one) + ellipse(1.5, 1.5, 2, 0.9, 5.5) + "duration = 8\n" +
            waypoint(points[0]) + waypoint(points[1]) + waypoint(points[2]));
  EXPECT_NEAR(solution.duration(), length_through(points), 1e-8);
}

/// In the middle of the last leg there is a short contact.
TEST_F(ClosedPaths, ThePathBeginsClearOfContacts) {
  const std::vector<Point> points{{-1.394, 0.285}, {1.303, -0.589}, {0.647, 1.364}};
  const Solution solution =
      found(closed(round_a_disc, speed_one) + ellipse(1.5, 1.5, 2.07, 0.9, 1.396) + "duration = 8\n" +
            waypoint(points[0]) + waypoint(points[1]) + waypoint(points[2]));
  EXPECT_NEAR(solution.duration(), length_through(points), 1e-8);
}

/// Of an angle that turns, and of an orbit that is closed by a reflection: beyond the end the guess goes on
/// as the path does.
TEST_F(ClosedGuesses, GoOnBeyondTheirEnds) {
  const std::string system = "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - 0.1*cos(2*x)\"\n";
  for (const auto& [map, guess] : {std::pair{"x + pi", "pi*t/T"}, std::pair{"-x", "cos(pi*t/T)"}}) {
    const Study s = study(fmt::format(
        "{}[boundary]\nperiodic = true\nmap = {{ x = \"{}\" }}\nduration = 2.0\n[guess]\nx = \"{}\"\n"
        "[[waypoints]]\nat = \"free\"\nx = -0.5\n",
        system, map, guess));
    const double time = s.problem.extension->waypoints.at(0).time;
    EXPECT_NEAR(time, 0.5, 1e-12) << map;
    EXPECT_NEAR(guessed(s, time, 0), -0.5, 0.01) << map;
    const double start = guessed(s, 0, 0), end = guessed(s, 1, 0);
    EXPECT_NEAR(end, std::string(map) == "-x" ? -start : start + pi, 1e-12);
  }
}

/// Of a search for more minimisers than there are, for a second: shifts in time of a closed path are one
/// path.
TEST_F(ClosedPaths, OfOneThatMayBeShiftedOneIsFound) {
  const std::vector<Solution> found =
      run_all(study(closed("\"x^2/4 + y^2 >= 1\"", "duration = 1\n") + ellipse(4, 2, 0) +
                    "[search]\nsolutions = 2\n[solve]\n"
                    "tolerance = 1e-4\nbudget = 1.0\n"));
  ASSERT_EQ(found.size(), 1u);
  // The perimeter of an ellipse with half axes 2 and 1.
  const double perimeter = 8 * std::comp_ellint_2(std::sqrt(0.75));
  EXPECT_NEAR(found[0].action, perimeter * perimeter / 2, 1e-3);
}

/// After two of these durations L repeats too, but not up to the map.
TEST_F(ClosedPaths, AMapRepeatsAfterNoMultiple) {
  const std::string text = message(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2 + x*cos(3*t)\"\n"
      "[boundary]\nperiodic = true\nmap = { x = \"-x\" }\nduration = \"2*pi/3\"\n"
      "[guess]\nx = \"0.1*cos(3*t)\"\n");
  EXPECT_NE(text.find("L repeats after 1.04719755119"), std::string::npos) << text;
  EXPECT_EQ(text.find("or a multiple of it"), std::string::npos) << text;
}
