#include <fmt/format.h>

#include <cmath>

#include "scenes.hpp"

/// \file Scenes that name a scheme: families, orbits, conjugate times.

using namespace extremal;
using namespace extremal::test;

namespace {

class SchemesOf : public Scenes {};

std::string solve_table(const std::string& scheme, const std::string& rest) {
  return fmt::format("[solve]\nscheme = \"{}\"\n{}\n", scheme, rest);
}

std::string continuation(const std::string& parameter, double to, int points) {
  return fmt::format("[continuation]\nparameter = \"{}\"\nto = {}\npoints = {}\n", parameter, to, points);
}

const std::string bratu =
    "[system]\ncoordinates = [\"x\"]\nparameters = { lambda = 1.0 }\n"
    "lagrangian = \"x'^2/2 - lambda*exp(x)\"\n[boundary]\nstart = { x = 0 }\nend = { x = 0 }\nduration = 1\n";

const std::string swinging =
    "[system]\nuse = \"pendulum\"\n[boundary]\nperiodic = true\nduration = 2.2\n"
    "[guess]\ntheta = \"1.2*cos(2*pi*t/T)\"\n";

}  // namespace

/// Each point is what a solve at its value gives, not an extremal of the exact equations.
TEST_F(SchemesOf, FamiliesAreTheirExtremals) {
  const std::string solving = solve_table("midpoint", "elements = 10");
  const FollowedBranch branch = follow(study(bratu + solving + continuation("lambda", 2.0, 5)));
  ASSERT_EQ(branch.points.size(), 5u);
  EXPECT_EQ(branch.branches.front().end, BranchEnd::target);
  EXPECT_NE(branch.branches.front().message.find("midpoint"), std::string::npos);
  for (const BranchPoint& point : branch.points) {
    const auto at = fmt::format("system.parameters.lambda={}", point.parameter);
    const Solution discrete = run(study(bratu + solving, {at})), exact = run(study(bratu, {at}));
    ASSERT_TRUE(discrete.converged() && exact.converged());
    EXPECT_NEAR(point.solution.action, discrete.action, 1e-12);
    EXPECT_GT(std::abs(point.solution.action - exact.action), 1e-6);
    EXPECT_EQ(point.solution.morse_index, discrete.morse_index);
    EXPECT_FALSE(branch.branches.front().worst_momentum);
  }
}

TEST_F(SchemesOf, FoldsEndFamilies) {
  LONG_TEST();
  const FollowedBranch branch =
      follow(study(bratu + solve_table("lobatto(3)", "elements = 8") + continuation("lambda", 4.0, 60)));
  EXPECT_EQ(branch.branches.front().end, BranchEnd::too_short) << branch.branches.front().message;
  EXPECT_NEAR(branch.points.back().parameter, 3.513830719, 1e-3);
  EXPECT_LT(branch.points.back().parameter, 3.5139);
}

TEST_F(SchemesOf, FamiliesOfOrbitsMeetTheTolerance) {
  const std::string orbit =
      "[system]\ncoordinates = [\"x\", \"y\"]\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3\"\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.1\n"
      "[guess]\nx = \"0.4*cos(2*pi*t/T)\"\ny = \"0.1*sin(2*pi*t/T)\"\nduration = 6.3\n";
  const std::string family = continuation("energy", 0.12, 4);
  const FollowedBranch exact = follow(study(orbit + family));
  const FollowedBranch discrete = follow(study(orbit + solve_table("gauss(2)", "tolerance = 1e-7") + family));
  ASSERT_EQ(discrete.points.size(), 4u);
  EXPECT_EQ(discrete.branches.front().end, BranchEnd::target);
  const auto agree = [](const BranchPoint& a, const BranchPoint& b) {
    ASSERT_NEAR(a.parameter, b.parameter, 1e-12);
    EXPECT_NEAR(a.solution.duration(), b.solution.duration(), 1e-6);
    EXPECT_NEAR(a.solution.action, b.solution.action, 1e-7);
    EXPECT_EQ(a.solution.morse_index, b.solution.morse_index);
    EXPECT_TRUE(a.solution.floquet);
  };
  agree(discrete.points.front(), exact.points.front());
  ASSERT_EQ(exact.branches.front().end, BranchEnd::target) << exact.branches.front().message;
  agree(discrete.points.back(), exact.points.back());
}

/// With forces the equations of both copies follow the parameter.
TEST_F(SchemesOf, FamiliesOfLimitCycles) {
  const std::string cycle =
      "[system]\nuse = \"van-der-pol\"\n[boundary]\nperiodic = true\nduration = \"free\"\n"
      "[guess]\nx = \"2*cos(2*pi*t/T)\"\nduration = 6.6\n";
  const FollowedBranch branch =
      follow(study(cycle + solve_table("gauss(3)", "elements = 80") + continuation("mu", 1.4, 4)));
  ASSERT_EQ(branch.points.size(), 4u);
  EXPECT_NEAR(branch.points.front().solution.duration(), 6.663286859323, 1e-5);
  const Solution last = run(study(cycle, {"system.parameters.mu=1.4"}));
  EXPECT_NEAR(branch.points.back().solution.duration(), last.duration(), 1e-5);
}

TEST_F(SchemesOf, FamiliesAreNotSwitched) {
  EXPECT_EQ(message(bratu + solve_table("midpoint", "elements = 10") + continuation("lambda", 2, 5) +
                    "switch = true\n"),
            "scene.toml:10:11: families of a scheme are followed from value to value, and branch points are "
            "not looked for; leave 'scheme' or 'switch' out");
}

/// Of guesses that lead the equations of a scheme nowhere, those without it still find an extremal.
TEST_F(SchemesOf, OrbitsAreFoundFromAPoorGuess) {
  const std::string orbit =
      "[system]\nuse = \"double-pendulum\"\n[boundary]\nperiodic = true\nduration = 2.4\n"
      "[guess]\na = \"0.3*cos(2*pi*t/T)\"\nb = \"0.4*cos(2*pi*t/T)\"\n";
  const Solution exact = run(study(orbit));
  ASSERT_TRUE(exact.converged()) << exact.message;
  for (const char* scheme : {"midpoint", "trapezoid", "gauss(2)", "lobatto(3)"}) {
    const Solution found = run(study(orbit + solve_table(scheme, "tolerance = 1e-5")));
    ASSERT_TRUE(found.converged()) << scheme << ": " << found.message;
    EXPECT_NEAR(found.action, exact.action, 1e-3 * std::abs(exact.action)) << scheme;
    EXPECT_NE(found.strategy.find("then the scheme from there"), std::string::npos) << found.strategy;
  }
}

/// The path bends outwards after half a second: few elements step over the bend, more of them end in it.
TEST_F(SchemesOf, MoreElementsMayMissWhatFewFind) {
  const std::string bent =
      "[system]\ncoordinates = [\"x\", \"y\"]\ndefinitions = { r = \"sqrt(x^2 + y^2)\", "
      "W = \"40*max(0, r - 1)^2/2\" }\nlagrangian = \"(x'^2 + y'^2)/2 - W + 0.5*(x*y' - y*x')\"\n"
      "[boundary]\nstart = { x = 0.2, y = 0 }\nend = { x = -0.3, y = 0.4 }\nduration = 2.4\n"
      "[guess]\nx = \"0.2 - 0.5*t/T + 1.2*step(t - 0.5)*max(0, min(t - 0.5, T - t))\"\ny = \"0.4*t/T\"\n";
  for (const char* scheme : {"midpoint", "trapezoid", "gauss(2)"}) {
    const Solution found = run(study(bent + solve_table(scheme, "tolerance = 1e-5")));
    ASSERT_TRUE(found.converged()) << scheme << ": " << found.message;
    EXPECT_NEAR(found.action, 0.07984990586, 1e-5) << scheme;
  }
}

/// The swinging begins at a turning point, so that half the period and the period are conjugate to its start.
TEST_F(SchemesOf, TheEndIsNoConjugateTime) {
  for (const char* scheme : {"", "midpoint", "trapezoid", "gauss(2)", "lobatto(3)", "gauss(4)"}) {
    const std::string solving = *scheme ? solve_table(scheme, "tolerance = 1e-5") : "";
    const Solution found = run(study(swinging + solving));
    ASSERT_TRUE(found.converged()) << scheme << ": " << found.message;
    ASSERT_EQ(found.conjugate_times.size(), 1u) << scheme;
    EXPECT_NEAR(found.conjugate_times.front(), 1.1, 1e-3) << scheme;
  }
}

/// A force that begins inside an element leaves errors of its length: more elements than there may be are
/// told from those before, and not tried.
TEST_F(SchemesOf, StepsInsideElementsTakeTheOrder) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - step(t - 0.8)*x/2\"\n"
                "[boundary]\nstart = { x = 0.2 }\nend = { x = 1 }\nduration = 1.5\n" +
                solve_table("gauss(3)", "")));
  EXPECT_FALSE(found.converged());
  EXPECT_NE(found.message.find("needs more than 1048576 elements"), std::string::npos) << found.message;
  EXPECT_TRUE(found.message.ends_with("; loosen it, or leave the scheme out")) << found.message;
}
