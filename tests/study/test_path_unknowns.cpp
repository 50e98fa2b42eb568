#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scenes.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"

/// \file Inequalities along the path with what else is found beside it: times of waypoints, the duration,
/// multipliers of integrals, unknown constants.

using namespace extremal;
using namespace extremal::test;

namespace {

const char* const beside_the_disc = "\"x^2 + y^2 >= 1\"";
const std::string round_the_disc = "start = { x = -2, y = 0 }\nend = { x = 2, y = 0 }\n";

std::string waypoint(const std::string& at, double x, double y) {
  return fmt::format("[[waypoints]]\nat = {}\nx = {:.17g}\ny = {:.17g}\n", at, x, y);
}

/// From (−2, 0) to (−1.5, 1.5), and on round the unit disc to (2, 0).
const double first_leg = std::sqrt(2.5), distance_of_point = 1.5 * std::sqrt(2.0);
const double second_leg = std::sqrt(distance_of_point * distance_of_point - 1) + std::sqrt(3.0) +
                          3 * std::numbers::pi / 4 - std::acos(1 / distance_of_point) - std::numbers::pi / 3;
const double both_legs = first_leg + second_leg;

/// A string under a load of k above a floor at h, by whose constants its contact is known in closed form: the
/// load lets it sag to the floor, which it leaves with the slope that is given at its end.
std::string sagging(const std::string& load, const std::string& floor, const std::string& boundary) {
  return fmt::format(
      "[system]\ncoordinates = [\"y\"]\n"
      "lagrangian = \"y'^2/2 + {}*y\"\n[path]\nconstraints = [\"y >= {}\"]\n[boundary]\nduration = 3\n{}",
      load, floor, boundary);
}

double unknown_found(const Solution& solution, std::size_t k = 0) {
  return solution.extension->unknowns.at(k).second;
}

}  // namespace

using PathUnknowns = UnderInequalities;

/// The least action is that of a constant speed.
TEST_F(PathUnknowns, AWaypointAtAFreeTime) {
  const Solution solution = found(
      free_particle(beside_the_disc, round_the_disc + "duration = 1\n" + waypoint("\"free\"", -1.5, 1.5)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.action, both_legs * both_legs / 2, 1e-8);
  EXPECT_NEAR(solution.extension->waypoints.at(0).time, first_leg / both_legs, 1e-9);
  EXPECT_NEAR(*solution.energy_drift, 0, 1e-8);
  EXPECT_TRUE(solution.minimizing);
}

/// At (0, 1) the way round the disc is in contact; at a time that is given its speed changes there.
TEST_F(PathUnknowns, AWaypointWithinAContact) {
  const double half = std::sqrt(3.0) + std::numbers::pi / 6;
  const Solution solution =
      found(free_particle(beside_the_disc, round_the_disc + "duration = 1\n" + waypoint("0.4", 0, 1)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.action, half * half / 2 * (1 / 0.4 + 1 / 0.6), 1e-8);
  EXPECT_NEAR(solution.extension->waypoints.at(0).impulse.at(0).second, half / 0.6 - half / 0.4, 1e-7);
  const Solution free =
      found(free_particle(beside_the_disc, round_the_disc + "duration = 1\n" + waypoint("\"free\"", 0, 1)));
  ASSERT_TRUE(free.converged());
  EXPECT_NEAR(free.action, 2 * half * half, 1e-8);
  EXPECT_NEAR(free.extension->waypoints.at(0).time, 0.5, 1e-8);
}

/// With the energy 2 the speed is 2 after the waypoint, and before it where its time is free.
TEST_F(PathUnknowns, TheEnergyDeterminesTheDurationBeyondAWaypoint) {
  const std::string ends = round_the_disc + "duration = \"free\"\nenergy = 2.0\n[guess]\nduration = 1.5\n";
  const Solution given = found(free_particle(beside_the_disc, ends + waypoint("0.3", -1.5, 1.5)));
  ASSERT_TRUE(given.converged());
  EXPECT_NEAR(given.duration(), 0.3 + second_leg / 2, 1e-8);
  const Solution free = found(free_particle(beside_the_disc, ends + waypoint("\"free\"", -1.5, 1.5)));
  ASSERT_TRUE(free.converged());
  EXPECT_NEAR(free.duration(), both_legs / 2, 1e-8);
  EXPECT_NEAR(free.extension->waypoints.at(0).time, first_leg / 2, 1e-8);
}

/// y'' = ν up to the ceiling at 1, which is reached at a: E = 1 + 2/a², and the area is T − 2a/3.
TEST_F(PathUnknowns, TheEnergyDeterminesTheWidthOfAnArea) {
  const double a = 0.3;
  const Solution solution = found(fmt::format(
      "[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2 - 1\"\n[path]\nconstraints = [\"y <= 1\"]\n"
      "[boundary]\nstart = {{ y = 0 }}\nend = {{ y = 0 }}\nduration = \"free\"\nenergy = {:.17g}\n"
      "integrals = [\"y = 0.8\"]\n[guess]\nduration = 1.2\n",
      1 + 2 / (a * a)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.duration(), 1, 1e-9);
  EXPECT_NEAR(solution.extension->integral_multipliers[0], -2 / (a * a), 1e-7);
  EXPECT_NEAR(solution.contacts->contacts.at(0).from, a, 1e-8);
}

/// The shortest curve round an area between two walls: half circles of radius 1, and straight
/// along the walls.
TEST_F(PathUnknowns, AClosedPathRoundAnArea) {
  const Solution solution =
      found(free_particle("\"y <= 1\", \"y >= -1\"",
                          "periodic = true\nduration = 1\nintegrals = [\"(x*y' - y*x')/2 = 6.0\"]\n"
                          "[guess]\nx = \"1.5*cos(2*pi*t/T)\"\ny = \"0.9*sin(2*pi*t/T)\"\n"));
  ASSERT_TRUE(solution.converged());
  const double straight = (6 - std::numbers::pi) / 2, length = 2 * std::numbers::pi + 2 * straight;
  EXPECT_NEAR(solution.action, length * length / 2, 1e-7);
  ASSERT_EQ(solution.contacts->contacts.size(), 2);
  EXPECT_NEAR(solution.contacts->contacts[0].to - solution.contacts->contacts[0].from, straight / length,
              1e-7);
  EXPECT_NEAR(solution.extension->integral_multipliers[0], -length, 1e-6);
}

/// A band round two discs that is lifted at (0, 2).
TEST_F(PathUnknowns, AClosedPathThroughAPoint) {
  const double r = std::sqrt(8.0), tangent = std::sqrt(r * r - 1);
  const double length =
      4 + 2 * tangent + 2 * (std::numbers::pi + std::acos(std::sqrt(0.5)) - std::acos(1 / r));
  for (const char* const at : {"0.25", "\"free\""}) {
    const Solution solution =
        found(free_particle("\"(x - 2)^2 + y^2 >= 1\", \"(x + 2)^2 + y^2 >= 1\"",
                            "periodic = true\nduration = 1\n[guess]\nx = \"4*cos(2*pi*t/T)\"\n"
                            "y = \"2*sin(2*pi*t/T)\"\n" +
                                waypoint(at, 0, 2)));
    ASSERT_TRUE(solution.converged());
    EXPECT_NEAR(solution.action, length * length / 2, 1e-7);
    EXPECT_NEAR(solution.extension->waypoints.at(0).impulse.at(1).second,
                -2 * length * std::sin(std::numbers::pi / 4 - std::asin(1 / r)), 1e-6);
  }
}

/// It leaves the floor with y'(T) = 1 at y(T) = h + 1/(2k).
TEST_F(PathUnknowns, ALoadThatLiftsTheEndSoFar) {
  const Solution solution = found(sagging(
      "k", "0", "start = { y = 1 }\nend = { p_y = 1 }\nunknowns = { k = 1.5 }\nwhere = [\"y(T) = 0.25\"]\n"));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(unknown_found(solution), 2, 1e-8);
  ASSERT_EQ(solution.contacts->contacts.size(), 1);
  EXPECT_NEAR(solution.contacts->contacts[0].from, 1, 1e-8);
  EXPECT_NEAR(solution.contacts->contacts[0].to, 2.5, 1e-8);
  EXPECT_TRUE(solution.minimizing);
}

/// y(0) = h + 2²/(2k) and y(T) = h + 1/(2k).
TEST_F(PathUnknowns, LoadAndFloorByBothEnds) {
  const Solution solution = found(sagging("k", "h",
                                          "start = { p_y = -2 }\nend = { p_y = 1 }\n"
                                          "unknowns = { h = 0.0, k = 3.0 }\n"
                                          "where = [\"y(T) = 0.45\", \"y(0) = 1.2\"]\n"));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(unknown_found(solution, 0), 0.2, 1e-8);
  EXPECT_NEAR(unknown_found(solution, 1), 2, 1e-8);
}

TEST_F(PathUnknowns, AMomentumOfTheStart) {
  const Solution solution = found(sagging("2", "0",
                                          "start = { p_y = \"-k\" }\nend = { p_y = 1 }\n"
                                          "unknowns = { k = 1.5 }\nwhere = [\"y(0) = 1\"]\n"));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(unknown_found(solution), 2, 1e-8);
}

/// From (−2, 0) along the disc to its top and straight on, at the speed 1.
TEST_F(PathUnknowns, TheRadiusOfADiscAndTheDuration) {
  const Solution solution =
      found(free_particle("\"x^2 + y^2 >= r^2\"",
                          "start = { x = -2, y = 0 }\nend = { x = 2 }\nduration = \"free\"\n"
                          "energy = 0.5\nunknowns = { r = 0.9 }\nwhere = [\"y(T) = 1.2\"]\n"
                          "[guess]\nduration = 3.0\n"));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(unknown_found(solution), 1.2, 1e-8);
  EXPECT_NEAR(solution.duration(), 1.6 + 1.2 * (std::numbers::pi / 2 - std::acos(0.6)) + 2, 1e-8);
}

/// Held throughout by a wall that swings.
TEST_F(PathUnknowns, TheHeightOfAWallThatSwings) {
  const double w = 2 * std::numbers::pi;
  const Solution solution = found(
      "[system]\ncoordinates = [\"y\"]\nparameters = { h = 0.0 }\nlagrangian = \"y'^2/2 + 9*y\"\n[path]\n"
      "constraints = [\"y >= h + 0.1*sin(2*pi*t)\"]\n[boundary]\nperiodic = true\nduration = 1.0\n"
      "unknowns = { h = 0.1 }\nwhere = [\"y(0) = 0.3\"]\n[guess]\ny = \"0.5\"\n");
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(unknown_found(solution), 0.3, 1e-9);
  EXPECT_NEAR(solution.action, w * w * 0.01 / 4 + 2.7, 1e-8);
}

TEST_F(PathUnknowns, ConditionsThatNoMinimiserSatisfies) {
  const Solution solution = run(study(
      sagging("k", "0",
              "start = { y = 1 }\nend = { p_y = 1 }\nunknowns = { k = 1.5 }\nwhere = [\"y(T) = -0.25\"]\n")));
  EXPECT_EQ(solution.status, Status::no_solution_near);
  EXPECT_NE(solution.message.find("no unknowns were found"), std::string::npos) << solution.message;
}

/// A ceiling that the string does not touch changes nothing.
TEST_F(PathUnknowns, AnUnknownThatDeterminesNothing) {
  LONG_TEST();
  const Solution solution =
      run(study("[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2 + 2*y\"\n[path]\n"
                "constraints = [\"y >= 0\", \"y <= h\"]\n[boundary]\nduration = 3\nstart = { y = 1 }\n"
                "end = { p_y = 1 }\nunknowns = { h = 5.0 }\nwhere = [\"y(T) = 0.45\"]\n"));
  EXPECT_EQ(solution.status, Status::no_solution_near);
  EXPECT_NE(solution.message.find("no unknowns were found"), std::string::npos) << solution.message;
}

/// A straight way to the disc at 150 degrees, from where the way round it is in contact.
TEST_F(PathUnknowns, AContactThatBeginsAtAWaypoint) {
  const double x = -std::sqrt(3.0) / 2, y = 0.5;
  const double arc = std::numbers::pi / 2 + std::sqrt(3.0), straight = std::hypot(2 + x, y);
  const std::string scene = round_the_disc + "duration = 1\n";
  const Solution given = found(free_particle(beside_the_disc, scene + waypoint("0.4", x, y)));
  ASSERT_TRUE(given.converged());
  EXPECT_NEAR(given.action, straight * straight / 0.8 + arc * arc / 1.2, 1e-8);
  const Solution free = run(study(free_particle(beside_the_disc, scene + waypoint("\"free\"", x, y))));
  EXPECT_FALSE(free.converged());
  EXPECT_NE(free.message.find("whose time is free; give its time as a number"), std::string::npos)
      << free.message;
}

TEST_F(PathUnknowns, AWaypointOnASurfaceFixesAllCoordinates) {
  const Solution solution =
      run(study(free_particle(beside_the_disc, round_the_disc + "duration = 1\n[[waypoints]]\nat = 0.4\n"
                                                                "x = -0.2\n")));
  EXPECT_FALSE(solution.converged());
  EXPECT_NE(solution.message.find("and leaves coordinates free; fix all of them there"), std::string::npos)
      << solution.message;
}

TEST_F(PathUnknowns, AFloorThatWouldBeAboveTheStart) {
  const Solution solution = run(study(
      sagging("2", "h",
              "start = { y = 1 }\nend = { p_y = 1 }\nunknowns = { h = 0.0 }\nwhere = [\"y(T) = 1.45\"]\n")));
  EXPECT_FALSE(solution.converged());
  EXPECT_EQ(solution.message,
            "the start does not keep the inequality 'y >= h' with the unknowns that satisfy 'where': it is "
            "missed by 0.2 there; give another start, or other conditions");
}

TEST_F(PathUnknowns, RefusesInequalitiesThatChangeTheEnergyAtAFreeTime) {
  EXPECT_EQ(message(free_particle("\"(x - 0.1*t)^2 + y^2 >= 1\"",
                                  round_the_disc + "duration = 1\n" + waypoint("\"free\"", -1.5, 1.5))),
            "scene.toml:11:6: inequalities that depend on t change the energy, which at = \"free\" makes "
            "continuous; give the time of the waypoint as a number");
}
