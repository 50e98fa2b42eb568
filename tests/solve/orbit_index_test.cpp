#include <fmt/format.h>

#include <numbers>
#include <span>

#include "solve/published.hpp"

/// \file Index and nullity of closed paths, and of paths at rest between conjugate ends, where elements that
/// resolve the path are too long for its second variation, or hide small eigenvalues of it.

namespace extremal::laws {
namespace {

const char* const one_coordinate = "coordinates = [\"x\"]\nlagrangian = ";
const char* const two_coordinates =
    "coordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y^2\"\n";

Solution at_rest(const std::string& system, const std::string& boundary) {
  return run(study_of("[system]\n" + system + "[boundary]\n" + boundary));
}

/// Fields cos and sin of nt/k have (n/k)² − 1: one eigenvalue for n = 0 and two for each n < k are negative,
/// the two of n = k are zero.
TEST(OrbitIndex, OfRestWithAPeriodOfItsOscillations) {
  for (int k = 1; k <= 8; ++k) {
    const std::string periodic = fmt::format("periodic = true\nduration = \"{}*pi\"\n", 2 * k);
    for (const char* lagrangian :
         {"\"x'^2/2 - x^2/2 - x^4/4\"\n", "\"x'^2/2 - x^2/2\"\n", "\"x'^2/2 - (1 - cos(x))\"\n"}) {
      const Solution s = at_rest(std::string(one_coordinate) + lagrangian, periodic + "[guess]\nx = \"0\"\n");
      EXPECT_EQ(s.morse_index, 2 * k - 1) << lagrangian;
      EXPECT_EQ(s.nullity, 2) << lagrangian << k;
    }
    const Solution s = at_rest(two_coordinates, periodic + "[guess]\nx = \"0\"\ny = \"0\"\n");
    EXPECT_EQ(s.morse_index, 2 * (2 * k - 1));
    EXPECT_EQ(s.nullity, 4) << k;
  }
}

/// sin(nπt/T) has (n/k)² − 1. The extremal has no neighbours but in the linear case.
TEST(OrbitIndex, OfRestBetweenConjugateEnds) {
  for (int k = 1; k <= 5; ++k)
    for (const char* lagrangian :
         {"\"x'^2/2 - x^2/2 - x^4/4\"\n", "\"x'^2/2 - x^2/2 + x^4/4\"\n", "\"x'^2/2 - (1 - cos(x))\"\n",
          "\"x'^2/2 - (x - 0.3)^2/2 - (x - 0.3)^4\"\n"}) {
      const double place = std::string(lagrangian).find("0.3") == std::string::npos ? 0 : 0.3;
      const Solution s = at_rest(
          std::string(one_coordinate) + lagrangian,
          fmt::format("start = {{ x = {0} }}\nend = {{ x = {0} }}\nduration = \"{1}*pi\"\n", place, k));
      ASSERT_TRUE(s.converged()) << lagrangian << s.message;
      EXPECT_EQ(s.morse_index, k - 1) << lagrangian;
      EXPECT_EQ(s.nullity, 1) << lagrangian << k;
      EXPECT_EQ(std::ssize(s.conjugate_times), k - 1) << lagrangian;
      for (const double x : s.trajectory.nodes) EXPECT_EQ(x, place);
    }
}

/// From the aphelion fields vanish in the plane at T alone; in space those across it at T/2 as well. Beyond
/// the pericentre little is left of their digits.
TEST(OrbitIndex, ThinEllipsesHaveNoMoreConjugateTimesThanTheirIndex) {
  const std::string
      plane = "coordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)\"\n",
      space =
          "coordinates = [\"x\", \"y\", \"z\"]\n"
          "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 + 1/sqrt(x^2 + y^2 + z^2)\"\n";
  for (const double e : {0.5, 0.9, 0.995, 0.9995, 0.9999, 0.99999, 0.999998}) {
    const std::string boundary =
        fmt::format("periodic = true\nduration = \"2*pi\"\n[guess]\nstate = {{ x = {}, \"y'\" = {} }}\n",
                    1 + e, std::sqrt((1 - e) / (1 + e)));
    const Solution in_plane = at_rest(plane, boundary), in_space = at_rest(space, boundary);
    ASSERT_TRUE(in_plane.converged()) << e << in_plane.message;
    ASSERT_TRUE(in_space.converged()) << e << in_space.message;
    EXPECT_EQ(in_plane.morse_index, 0) << e;
    EXPECT_TRUE(in_plane.conjugate_times.empty()) << e;
    EXPECT_GT(in_plane.windows.front()[1], 0.99 * in_plane.duration()) << e;
    EXPECT_EQ(in_space.morse_index, 1) << e;
    ASSERT_EQ(in_space.conjugate_times.size(), 1u) << e;
    EXPECT_NEAR(in_space.conjugate_times.front(), std::numbers::pi, 1e-6) << e;
  }
}

/// Ellipses run through k times: 2(k − 1), and the directions of all ellipses of one period.
TEST(OrbitIndex, OfCoversOfKeplerOrbits) {
  for (int k = 1; k <= 4; ++k)
    for (const double tolerance : {1e-6, 1e-9, 1e-12})
      for (const double e : {0.2, 0.6}) {
        const Solution s = at_rest(
            "coordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)\"\n",
            fmt::format(
                "periodic = true\nduration = \"{}*pi\"\n[guess]\nstate = {{ x = {}, y = 0, \"x'\" = 0, "
                "\"y'\" = {} }}\n[solve]\ntolerance = {}\n",
                2 * k, 1 - e, std::sqrt((1 + e) / (1 - e)), tolerance));
        EXPECT_EQ(s.morse_index, 2 * (k - 1)) << k << " " << tolerance << " " << e;
        EXPECT_EQ(s.nullity, 3) << k << " " << tolerance << " " << e;
      }
}

/// 542 transition matrices make a Hessian with 15 negative eigenvalues and four of 1e-9; those next to zero
/// beside them are 3e-6 and −0.05. That of the elements of the path had six of 1e-8 or less.
TEST(OrbitIndex, OfThreeBodiesWithCloseEncounters) {
  const Solution s = solved(published("nbody_periodic_orbits.json", "3b-sd-IB3-butterflyIII"), 1e-9);
  EXPECT_EQ(s.morse_index, 15);
  EXPECT_EQ(s.nullity, 4);
}

/// x = a cos(t + α), y = b cos(2t + β) all have the period 2π. Fields of cos and sin of nt are negative for
/// n < 1 in x and n < 2 in y, and zero for n = 1 and n = 2.
TEST(OrbitIndex, AlongAFamilyOfIsochronousOrbits) {
  const FollowedBranch branch = follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - (x^2 + 4*y^2)/2\"\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 1\n[guess]\nx = \"cos(2*pi*t/T)\"\n"
      "y = \"0.4*sin(4*pi*t/T)\"\nduration = 6.2\n"
      "[continuation]\nparameter = \"energy\"\nto = 3\npoints = 20\n"));
  ASSERT_GT(branch.points.size(), 2u);
  // At the end of the range it is that of the elements, which may not tell it.
  for (const BranchPoint& point : std::span(branch.points).first(branch.points.size() - 1)) {
    EXPECT_EQ(point.solution.morse_index, 4) << point.parameter;
    EXPECT_EQ(point.solution.nullity, 4) << point.parameter;
  }
}

}  // namespace
}  // namespace extremal::laws
