#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Families whose first member alone is one of a continuum, by symmetries or by natural ends that
/// nothing holds, against closed forms of the eigenvalues of their second variations.

namespace extremal::laws {
namespace {

using std::numbers::pi;

std::vector<BranchPoint> followed(const std::string& scene) { return follow(study_of(scene)).points; }

/// With the parameters and the continuation put where the text has a line %.
std::vector<BranchPoint> family(std::string text, double from, double to) {
  const std::string parameters = fmt::format("parameters = {{ a = {} }}\n", from);
  text.replace(text.find('%'), 1, parameters);
  return followed(text + fmt::format("[continuation]\nparameter = \"a\"\nto = {}\npoints = 30\n", to));
}

/// At all regular points.
void expect_index(const std::vector<BranchPoint>& points, const std::function<int(double)>& index,
                  const std::function<int(double)>& nullity) {
  for (const BranchPoint& point : points) {
    if (point.kind != PointKind::regular) continue;
    EXPECT_EQ(point.solution.morse_index, index(point.parameter)) << point.parameter;
    EXPECT_EQ(point.solution.nullity, nullity(point.parameter)) << point.parameter;
  }
}

/// Straight motions in x above a potential of y: at a = 0 any y will do. Eigenvalues (πn)² − a.
const std::string along_x =
    "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - a*(1 - cos(y))\"\n%"
    "[boundary]\nperiodic = true\nmap = { x = \"x + 1\" }\nduration = 2\n[guess]\nx = \"t/T\"\n";

int index_along_x(double a) {
  int index = a > 0 ? 1 : 0;
  for (int n = 1; a > pi * pi * n * n; ++n) index += 2;
  return index;
}

TEST(FamilySymmetries, ATranslationOfTheFirstMember) {
  struct Way {
    double from, to;
  };
  for (const Way& way : {Way{0, 12}, {0, -3}, {-3, 12}, {12, 0}}) {
    const double from = way.from, to = way.to;
    const std::vector<BranchPoint> points = family(along_x + "y = \"0\"\n", from, to);
    EXPECT_EQ(points.front().parameter, from);
    EXPECT_EQ(points.back().parameter, to);
    expect_index(points, index_along_x, [](double a) { return a == 0 ? 2 : 1; });
    std::vector<double> expected = {0, pi * pi}, found = values(points, PointKind::branch);
    const auto inside = [&](double a) { return (a - from) * (a - to) < -1e-9; };
    std::erase_if(expected, std::not_fn(inside));
    std::erase_if(found, std::not_fn(inside));
    std::ranges::sort(found);
    ASSERT_EQ(found.size(), expected.size()) << from;
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9);
    for (const BranchPoint& point : points) {
      if (point.kind != PointKind::branch || !inside(point.parameter)) continue;
      const bool first = std::abs(point.parameter) < 1;
      EXPECT_EQ(point.solution.morse_index, first ? 0 : 1) << from;
      EXPECT_EQ(point.solution.nullity, first ? 2 : 3) << from;
    }
  }
}

/// A member of the continuum that does not lead on.
TEST(FamilySymmetries, NoBranchFromAnotherMember) {
  const std::vector<BranchPoint> points = family(along_x + "y = \"0.3\"\n", 0, 12);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].solution.morse_index, 0);
  EXPECT_EQ(points[0].solution.nullity, 2);
}

/// The geodesic x² + y² = 1 of an ellipsoid whose third semiaxis is c: z'' = −(2π/c)² z. At c = 1 any great
/// circle will do.
TEST(FamilySymmetries, TheEquatorOfASphere) {
  LONG_TEST();
  const std::vector<BranchPoint> points = family(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"x^2 + y^2 + z^2/a^2 = 1\"]\n%[boundary]\nperiodic = true\nduration = 1\n"
      "[guess]\nx = \"cos(2*pi*t)\"\ny = \"sin(2*pi*t)\"\nz = \"0\"\n",
      1, 0.45);
  expect_index(
      points,
      [](double c) {
        int index = 1;
        for (int n = 1; n * c < 1; ++n) index += 2;
        return index;
      },
      [](double c) { return c == 1 ? 3 : 1; });
  const std::vector<double> found = values(points, PointKind::branch);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 0.5, 1e-9);
}

/// Of y with natural ends: (πn/2)² − a.
TEST(FamilySymmetries, NaturalEndsThatNothingHolds) {
  const std::vector<BranchPoint> points = family(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - a*y^2/2 - x^2/2\"\n%"
      "[boundary]\nstart = { x = 1 }\nend = { x = 0 }\nduration = 2\n",
      0, 5);
  expect_index(
      points, [](double a) { return a == 0            ? 0
                                    : a < pi * pi / 4 ? 1
                                                      : 2; },
      [](double a) { return a == 0 ? 1 : 0; });
  const std::vector<double> found = values(points, PointKind::branch);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], pi * pi / 4, 1e-10);
}

/// By x and √a y: a rotation that depends on the parameter.
TEST(FamilySymmetries, ThatDependOnTheParameter) {
  const std::vector<BranchPoint> points = family(
      "[system]\ncoordinates = [\"x\", \"y\"]\n%lagrangian = \"(x'^2 + a*y'^2)/2 - (x^2 + a*y^2)/2 - (x^2 + "
      "a*y^2)^2/4\"\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.5\n"
      "[guess]\nx = \"0.8*cos(2*pi*t/T)\"\ny = \"0.3*cos(2*pi*t/T)\"\nduration = 5.4\n",
      1, 2);
  ASSERT_EQ(points.back().parameter, 2);
  expect_index(
      points, [](double) { return 3; }, [](double) { return 2; });
}

/// x = √(2E) cos t in a quadratic well, of one period for all energies, and y'' + (1 + 4aE cos² t) y = 0:
/// multipliers +1 of this equation of Hill, integrated by other means.
const std::string isochronous =
    "[system]\ncoordinates = [\"x\", \"y\"]\n%lagrangian = \"(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - a*x^2*y^2 - "
    "y^4/4\"\n"
    "[boundary]\nperiodic = true\nduration = \"free\"\nCLOSED\n"
    "[guess]\nx = \"1.4*cos(2*pi*t/T)\"\ny = \"0\"\nduration = 6.28\n";
const std::vector<double> of_hill = {1.417047248996, 2.154009789147, 4.131027342739};

void expect_isochronous(const std::vector<BranchPoint>& points, double energy) {
  const std::vector<double> found = values(points, PointKind::branch);
  ASSERT_EQ(found.size(), of_hill.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k] * energy, of_hill[k], 1e-8);
  expect_index(
      points,
      [&](double a) {
        return 4 + static_cast<int>(std::ranges::count_if(of_hill, [&](double x) { return a * energy > x; }));
      },
      [](double) { return 2; });
}

TEST(Isochronous, InAParameter) {
  for (const auto& [closed, energy] : {std::pair("energy = 1", 1.0), {"where = \"x(0) = 1.2\"", 0.72}}) {
    std::string text = isochronous;
    text.replace(text.find("CLOSED"), 6, closed);
    expect_isochronous(family(text, 0.2, 5 / energy), energy);
  }
}

TEST(Isochronous, InTheEnergy) {
  std::string text = isochronous;
  text.replace(text.find("CLOSED"), 6, "energy = 0.2").replace(text.find('%'), 1, "parameters = { a = 1 }\n");
  expect_isochronous(followed(text + "[continuation]\nparameter = \"energy\"\nto = 5\npoints = 30\n"), 1);
}

/// A spring pendulum that swings along the vertical, with the period 2π/√k: y'' of the angle is that of Hill
/// again. Orbits of twice the period begin at k = 8.5212775 (integrated by other means), and are followed.
TEST(Isochronous, OrbitsOfTwiceThePeriod) {
  const FollowedBranch found = follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { k = 7 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
      "k*(sqrt(x^2 + y^2) - 1)^2/2 - y\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0\n"
      "[guess]\nx = \"0\"\ny = \"-1.25 + 0.5*cos(2*pi*t/T)\"\nduration = 2.4\n[continuation]\nparameter = "
      "\"k\"\nto = 10\npoints = 15\nswitch = true\n"));
  std::vector<double> doubled = values(found.points, PointKind::period_doubling);
  ASSERT_FALSE(doubled.empty());
  EXPECT_NEAR(doubled[0], 8.5212775, 1e-6);
  ASSERT_EQ(found.branches.size(), 2u);
  EXPECT_GT(found.branches[1].points, 5);
}

/// Orbits whose y turns twice a period begin at the x-axis and end at the y-axis, on an orbit run through
/// twice: beyond are the same ones half a period later.
TEST(HalfPeriods, EndAFamilyThatTurnsBackThere) {
  const FollowedBranch found = follow(
      study_of("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - x^4/4 - y^2 - "
               "0.3*x^2*y^2\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.12\n"
               "[guess]\nx = \"0.83*cos(2*pi*t/T)\"\nduration = 9\n[continuation]\nparameter = \"energy\"\n"
               "to = 1.7\npoints = 40\nswitch = true\n"));
  int crossing = 0;
  for (std::size_t k = 1; k < found.branches.size(); ++k) {
    const BranchRecord& record = found.branches[k];
    if (found.points[*record.origin].kind != PointKind::branch) continue;
    ++crossing;
    EXPECT_EQ(record.end, BranchEnd::closed) << record.message;
  }
  EXPECT_GE(crossing, 2);
}

/// In a double well two families turn back at one energy where they meet an orbit run through twice. Roundoff
/// hides where, as the equations are doubly singular.
TEST(HalfPeriods, EndAFamilyWhereRoundoffHidesItsFold) {
  const FollowedBranch found = follow(
      study_of("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + x^2/2 - x^4/4 - "
               "0.8*y^2 - x^2*y^2\"\n[boundary]\nperiodic = true\nduration = \"free\"\n"
               "energy = 0.3132846854\n[guess]\nduration = 8.0\n"
               "state = { x = 1.166356, y = 0.495685, \"x'\" = 0, \"y'\" = 0 }\n[continuation]\n"
               "parameter = \"energy\"\nto = 2\npoints = 60\n"));
  EXPECT_EQ(found.branches[0].end, BranchEnd::closed) << found.branches[0].message;
  EXPECT_NEAR(found.points.back().parameter, 0.52740258, 1e-7);
}

}  // namespace
}  // namespace extremal::laws
