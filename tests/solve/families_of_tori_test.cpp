#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Families of integrable systems with resonances: the orbits with one value fill tori, of which no
/// symmetry of L moves one onto another.

namespace extremal::laws {
namespace {

using std::numbers::pi;

const std::string kepler =
    "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 1 }\nlagrangian = \"(x'^2 + y'^2)/2 + "
    "g/sqrt(x^2 + y^2)\"\n[boundary]\nperiodic = true\n";
const std::string circle = "[guess]\nx = \"0.8*cos(2*pi*t/T)\"\ny = \"0.9*sin(2*pi*t/T)\"\n";
const std::string ellipse = "[guess]\nx = \"cos(2*pi*t/T) - 0.5\"\ny = \"0.87*sin(2*pi*t/T)\"\n";

std::string to(const std::string& parameter, double value) {
  return fmt::format("[continuation]\nparameter = \"{}\"\nto = {}\npoints = 20\n", parameter, value);
}

/// All the way, with one index and nullity throughout.
std::vector<BranchPoint> expect_followed(const std::string& scene, int index, int nullity) {
  const FollowedBranch found = follow(study_of(scene));
  EXPECT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  for (const BranchPoint& point : found.points) {
    EXPECT_EQ(point.kind, PointKind::regular) << point.parameter;
    EXPECT_EQ(point.solution.morse_index, index) << point.parameter;
    EXPECT_EQ(point.solution.nullity, nullity) << point.parameter;
    EXPECT_LT(point.momentum_difference, 1e-9) << point.parameter;
  }
  return found.points;
}

/// Shifts of time, rotations, and ellipses that are longer and narrower; of circles, two kinds of those, and
/// rotations are shifts of time.
TEST(FamiliesOfTori, KeplerByTheEnergy) {
  for (const std::string& guess : {circle, ellipse})
    for (const BranchPoint& point : expect_followed(kepler + "duration = \"free\"\nenergy = -0.5\n" + guess +
                                                        "duration = 6.2\n" + to("energy", -0.2),
                                                    0, 3)) {
      const double period = 2 * pi * std::pow(-2 * point.parameter, -1.5);
      EXPECT_NEAR(point.solution.duration(), period, 1e-8 * period);
    }
}

TEST(FamiliesOfTori, KeplerByThePeriodAndByGravity) {
  for (const BranchPoint& point :
       expect_followed(kepler + "duration = 6\n" + ellipse + to("duration", 12), 0, 3))
    EXPECT_NEAR(*point.solution.energy, -std::pow(2 * pi / point.parameter, 2.0 / 3) / 2, 1e-8);
  for (const BranchPoint& point : expect_followed(kepler + "duration = 6\n" + ellipse + to("g", 3), 0, 3))
    EXPECT_NEAR(*point.solution.energy, -std::pow(2 * pi * point.parameter / 6, 2.0 / 3) / 2, 1e-8);
}

/// Frequencies 1 and 2: all orbits close, and eigenvalues (n/k)² − 1 of the k-th multiple are as many of
/// either sign at every energy: below n = 1 and n = 2 there are 1 and 3 fields, 4 in all.
TEST(FamiliesOfTori, TwoOscillatorsInResonance) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - (x^2 + 4*y^2)/2\"\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 1\n"
      "[guess]\nx = \"cos(2*pi*t/T)\"\ny = \"0.4*sin(4*pi*t/T)\"\nduration = 6.2\n";
  for (const BranchPoint& point : expect_followed(scene + to("energy", 3), 4, 4))
    EXPECT_NEAR(point.solution.duration(), 2 * pi, 1e-9);
}

/// Calogero's system: as its particles without repulsion, with periods 2π. All six multipliers are 1.
TEST(FamiliesOfTori, Calogero) {
  const std::string scene =
      "[system]\ncoordinates = [\"a\", \"b\", \"c\"]\nparameters = { g = 0.5 }\nlagrangian = \"(a'^2 + b'^2 "
      "+ c'^2)/2 - (a^2 + b^2 + c^2)/2 - g/(a - b)^2 - g/(b - c)^2 - g/(a - c)^2\"\n"
      "[boundary]\nperiodic = true\nduration = \"2*pi\"\n"
      "[guess]\na = \"-1.3 + 0.3*cos(t)\"\nb = \"0.1*sin(t)\"\nc = \"1.4\"\n";
  expect_followed(scene + to("g", 2), 9, 6);
}

/// Standing waves of three particles: at every energy a family, one multiplier more than symmetries make.
TEST(FamiliesOfTori, Toda) {
  const std::string scene =
      "[system]\ncoordinates = [\"a\", \"b\", \"c\"]\nlagrangian = \"(a'^2 + b'^2 + c'^2)/2 - exp(a - b) - "
      "exp(b - c) - exp(c - a) + 3\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.2\n"
      "[guess]\na = \"0.2*sin(2*pi*t/T)\"\nb = \"0\"\nc = \"-0.2*sin(2*pi*t/T)\"\nduration = 3.6\n";
  for (const BranchPoint& point : expect_followed(scene + to("energy", 20), 4, 3)) {
    ASSERT_TRUE(point.solution.floquet);
    for (const auto& multiplier : point.solution.floquet->multipliers)
      EXPECT_NEAR(std::abs(multiplier - 1.0), 0, 1e-5) << point.parameter;
  }
}

}  // namespace
}  // namespace extremal::laws
