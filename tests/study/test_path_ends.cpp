#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "problem/inequalities.hpp"
#include "scenes.hpp"
#include "solution/path_contacts.hpp"

/// Inequalities along the path with free durations, closed paths, constraints, and ends that are not points.

using namespace extremal;
using namespace extremal::test;

namespace {

const double straight_angle = std::numbers::pi;

const char* const unit_disc = "\"x^2 + y^2 >= 1\"";
const char* const two_discs = "\"(x - 2)^2 + y^2 >= 1\", \"(x + 2)^2 + y^2 >= 1\"";
const char* const opposite_ends = "start = { x = -2.0, y = 0.0 }\nend = { x = 2.0, y = 0.0 }\n";
/// Round both discs; t = 0 is where the path is in contact.
const char* const wide_loop = "[guess]\nx = \"4*cos(2*pi*t/T)\"\ny = \"2*sin(2*pi*t/T)\"\n";

/// Round the unit disc from (−2, 0) to (2, 0).
const double round_disc = 2 * std::sqrt(3) + straight_angle / 3;
const double round_both = 8 + 2 * straight_angle;

/// On the unit sphere, with start and end at an angle from the pole.
std::string on_sphere(const std::string& constraints, double angle, double turn) {
  return fmt::format(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
      "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[path]\nconstraints = [{}]\n[boundary]\n"
      "start = {{ x = {:.17g}, y = 0.0, z = {:.17g} }}\nend = {{ x = {:.17g}, y = {:.17g}, z = {:.17g} }}\n"
      "duration = 1.0\n",
      constraints, std::sin(angle), std::cos(angle), std::sin(angle) * std::cos(turn),
      std::sin(angle) * std::sin(turn), std::cos(angle));
}

std::vector<double> state_at(const Solution& solution, double t, std::vector<double>& v) {
  std::vector<double> q(solution.trajectory.coordinates);
  v.resize(q.size());
  solution.trajectory.at(t, q, v);
  return q;
}

double force_at(const Solution& solution, double t) {
  std::vector<double> v;
  const std::vector<double> q = state_at(solution, t, v);
  return solution.contacts->forces(q, v, t).front();
}

}  // namespace

using PathEnds = UnderInequalities;

TEST_F(PathEnds, TheEnergyDeterminesTheDuration) {
  for (const double guess : {2.0, 50.0}) {
    const Solution solution = found(free_particle(
        unit_disc,
        fmt::format("{}duration = \"free\"\nenergy = 2.0\n[guess]\nduration = {}\n", opposite_ends, guess)));
    ASSERT_TRUE(solution.converged());
    EXPECT_NEAR(solution.duration(), round_disc / 2, 1e-9);
    EXPECT_NEAR(*solution.energy, 2, 1e-9);
    EXPECT_NEAR(solution.action, round_disc, 1e-9);
  }
}

TEST_F(PathEnds, AConditionDeterminesTheDuration) {
  // Straight on at speed 1 from the top of the disc.
  const Solution solution = found(free_particle(
      unit_disc,
      "start = { x = -2.0, y = 0.1 }\nend = { p_x = 1.0 }\nwhere = \"x(T) = 2\"\nduration = \"free\"\n"
      "[guess]\nduration = 3.0\n"));
  ASSERT_TRUE(solution.converged());
  const double r = std::hypot(2, 0.1);
  const double length = std::sqrt(r * r - 1) + straight_angle / 2 - std::atan2(0.1, 2) - std::acos(1 / r) + 2;
  EXPECT_NEAR(solution.duration(), length, 1e-8);
  EXPECT_NEAR(*solution.energy, 0.5, 1e-8);
}

TEST_F(PathEnds, AnEnergyThatNoMinimiserHasIsTold) {
  LONG_TEST();
  // The hill between the ends is higher; slow minimisers come near its top.
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\n"
                "lagrangian = \"(x'^2 + y'^2)/2 - 2*exp(-x^2)\"\n[path]\n"
                "constraints = [\"x^2 + y^2 >= 0.5\"]\n[boundary]\n"
                "start = { x = -3.0, y = 0.1 }\nend = { x = 3.0, y = 0.2 }\nduration = \"free\"\n"
                "energy = 1.0\n[guess]\nduration = 2.0\n[solve]\nbudget = 20.0\n"));
  EXPECT_EQ(solution.status, Status::no_solution_near);
  EXPECT_NE(solution.message.find("no minimiser near the guess has this energy: the nearest is"),
            std::string::npos)
      << solution.message;
}

TEST_F(PathEnds, ABandRoundTwoDiscs) {
  LONG_TEST();
  const Solution solution =
      found(free_particle(two_discs, fmt::format("periodic = true\nduration = 1.0\n{}", wide_loop)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.action, round_both * round_both / 2, 1e-7);
  EXPECT_TRUE(solution.minimizing);
  double contact = 0;
  for (const Contact& each : solution.contacts->contacts) contact += each.to - each.from;
  EXPECT_NEAR(contact, 2 * straight_angle / round_both, 1e-8);
}

TEST_F(PathEnds, TheEnergyDeterminesThePeriodOfABand) {
  const Solution solution = found(free_particle(
      two_discs,
      fmt::format("periodic = true\nduration = \"free\"\nenergy = 0.5\n{}duration = 10.0\n", wide_loop)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.duration(), round_both, 1e-8);
  EXPECT_NEAR(solution.action, round_both / 2, 1e-8);
}

TEST_F(PathEnds, AClosedPathMayBeHeldThroughout) {
  const Solution solution =
      found(free_particle(unit_disc, fmt::format("periodic = true\nduration = 2.0\n{}", wide_loop)));
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.action, straight_angle * straight_angle, 1e-9);
  ASSERT_EQ(solution.contacts->contacts.size(), 1u);
  EXPECT_NEAR(force_at(solution, 0.3), straight_angle * straight_angle / 2, 1e-7);
}

TEST_F(PathEnds, AWallThatSwings) {
  // 9 + A w² sin(w t) presses throughout.
  const double w = 2 * straight_angle;
  const Solution solution = found(
      "[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2 + 9*y\"\n[path]\n"
      "constraints = [\"y >= 0.1*sin(2*pi*t)\"]\n[boundary]\nperiodic = true\nduration = 1.0\n"
      "[guess]\ny = \"0.5\"\n");
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(force_at(solution, 0.2), 9 + 0.1 * w * w * std::sin(0.2 * w), 1e-6);
  EXPECT_NEAR(solution.action, w * w * 0.01 / 4, 1e-9);
}

TEST_F(PathEnds, AGeodesicRoundACap) {
  const double angle = 1.2, turn = 3.0, cap = std::acos(0.8);
  const Solution solution = found(on_sphere("\"z <= 0.8\"", angle, turn));
  ASSERT_TRUE(solution.converged());
  // Great circles that touch the parallel, by right spherical triangles.
  const double length = 2 * std::acos(std::cos(angle) / std::cos(cap)) +
                        std::sin(cap) * (turn - 2 * std::acos(std::tan(cap) / std::tan(angle)));
  EXPECT_NEAR(solution.action, length * length / 2, 1e-8);
  // On the parallel of radius ρ: μ = z v²/ρ², λ = −v²/(2 ρ²).
  const double square = length * length, rho = std::sin(cap);
  EXPECT_NEAR(force_at(solution, 0.5), 0.8 * square / (rho * rho), 1e-6);
  std::vector<double> v;
  const std::vector<double> q = state_at(solution, 0.5, v);
  EXPECT_NEAR(solution.contacts->constraint_forces(q, v, 0.5).front(), -square / (2 * rho * rho), 1e-6);
}

TEST_F(PathEnds, AGeodesicThatTouchesNothing) {
  const Solution solution = found(on_sphere("\"z <= 0.8\"", 1.4, 1.0));
  ASSERT_TRUE(solution.converged());
  EXPECT_TRUE(solution.contacts->contacts.empty());
  const double cosine = std::pow(std::cos(1.4), 2) + std::pow(std::sin(1.4), 2) * std::cos(1.0);
  EXPECT_NEAR(solution.action, std::pow(std::acos(cosine), 2) / 2, 1e-9);
}

TEST_F(PathEnds, AFreeEndIsPressedAgainstAWall) {
  // With the momentum −5 at the end, y would go to −4. At the wall p = −1; the wall gives the rest.
  const Solution solution = found(
      "[system]\ncoordinates = [\"y\"]\nlagrangian = \"y'^2/2\"\n[path]\nconstraints = [\"y >= 0\"]\n"
      "[boundary]\nstart = { y = 1.0 }\nend = { p_y = -5.0 }\nduration = 1.0\n");
  ASSERT_TRUE(solution.converged());
  EXPECT_NEAR(solution.action, 0.5, 1e-10);
  EXPECT_NEAR(solution.momentum_end.front(), -1, 1e-9);
  ASSERT_EQ(solution.contacts->contacts.size(), 1u);
  EXPECT_EQ(solution.contacts->contacts.front().from, 1);
}

TEST_F(PathEnds, AnEndOnACurve) {
  const Solution solution = found(free_particle(
      unit_disc,
      "conditions = [\"x(0) = -2\", \"y(0) = 0.1\", \"(x(T) - 3)^2 + y(T)^2 = 0.25\"]\nduration = 1.0\n"));
  ASSERT_TRUE(solution.converged());
  const double r = std::hypot(2, 0.1), angle = straight_angle - std::atan2(0.1, 2);
  const double length =
      std::sqrt(r * r - 1) + std::sqrt(8) + angle - std::acos(1 / r) - std::acos(1 / 3.0) - 0.5;
  EXPECT_NEAR(solution.action, length * length / 2, 1e-8);
}

TEST_F(PathEnds, UnitsDoNotMatter) {
  const auto scene = [](double size, double time, double action) {
    return fmt::format(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"{:.17g}*(x'^2 + y'^2)/2 - "
        "{:.17g}*y\"\n[path]\n"
        "constraints = [\"x^2 + (y + {:.17g})^2 >= {:.17g}\"]\n[boundary]\n"
        "start = {{ x = {:.17g}, y = 0.0 }}\nend = {{ x = {:.17g}, y = 0.0 }}\nduration = {:.17g}\n",
        action * time * time / (size * size) / time, 2 * action / size / time, 0.3 * size, size * size,
        -2 * size, 2 * size, 1.5 * time);
  };
  const Solution unit = found(scene(1, 1, 1));
  for (const double size : {1e-3, 1e5})
    for (const double time : {1e-4, 1e3}) {
      const Solution other = found(scene(size, time, 7));
      ASSERT_TRUE(other.converged());
      EXPECT_NEAR(other.action, 7 * unit.action, 1e-8 * 7 * std::abs(unit.action));
      ASSERT_EQ(other.contacts->contacts.size(), unit.contacts->contacts.size());
      for (std::size_t k = 0; k < unit.contacts->contacts.size(); ++k)
        EXPECT_NEAR(other.contacts->contacts[k].from / time, unit.contacts->contacts[k].from, 1e-7);
    }
}

TEST_F(PathEnds, RefusesWhatDoesNotRecur) {
  const auto refused = [&](const std::string& scene, const std::string& what) {
    const std::string text = message(scene);
    EXPECT_NE(text.find(what), std::string::npos) << text;
  };
  refused(free_particle("\"(x - 0.3*t)^2 + y^2 >= 1\"",
                        fmt::format("periodic = true\nduration = 1.0\n{}", wide_loop)),
          "a closed path recurs only if the inequalities do");
  refused(free_particle(
              "\"(x - 0.3*t)^2 + y^2 >= 1\"",
              fmt::format("{}duration = \"free\"\nenergy = 1.0\n[guess]\nduration = 2.0\n", opposite_ends)),
          "inequalities that depend on t change the energy");
}

TEST_F(PathEnds, TheEnergyNearestToTheOneGiven) {
  LONG_TEST();
  // Parabolas of the duration T have the energy 2.005/T² + T²/2 + 0.7, at least 2.7025.
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - 2*y\"\n[path]\n"
                "constraints = [\"y >= -0.5 + 0.2*x\"]\n[boundary]\nstart = { x = -1.0, y = 0.4 }\n"
                "end = { x = 1.0, y = 0.3 }\nduration = \"free\"\nenergy = 2.0\n[guess]\nduration = 1.5\n"));
  EXPECT_EQ(solution.status, Status::no_solution_near);
  EXPECT_NE(solution.message.find("the nearest is about 2.702, at a duration of 1.415"), std::string::npos)
      << solution.message;
}
