#include "machine/long_test.hpp"
#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Events of branches that signs of tests do not show, and branches that come back to where they began.

namespace extremal::laws {
namespace {

/// x = cn along y = 0 in the potential (x⁴ + y⁴)/4 + a x²y²/2: over half a period the trace of y'' + a x² y =
/// 0 is 2√2 cos(π √(1 + 8a)/4) (H. Yoshida, Celest. Mech. 32 (1984) 73). Over the whole period it touches −2
/// where that is zero.
TEST(BranchEvents, TwoMultipliersThatPassMinusOneAtOnce) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { a = 0.2 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
      "(x^4 + "
      "y^4)/4 - a*x^2*y^2/2\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.25\n[guess]\nx = "
      "\"cos(2*pi*t/T)\"\ny = \"0\"\nduration = 7.4\n[continuation]\nparameter = \"a\"\nto = 5\npoints = "
      "40\n"));
  const std::vector<double> doubled = values(found.points, PointKind::period_doubling);
  ASSERT_EQ(doubled.size(), 2u);
  EXPECT_NEAR(doubled[0], 3.0 / 8, 1e-7);
  EXPECT_NEAR(doubled[1], 35.0 / 8, 1e-7);
}

/// Orbits of twice the period of the drive that begin at one period doubling and end at another one. Beyond
/// it they would be the same ones, one period of the drive later.
TEST(BranchEvents, ABranchThatComesBackToHalfItsPeriod) {
  LONG_TEST();
  const Study study = study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { w = 1.5 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
      "(x^2 "
      "+ y^2)/2 - 0.5*x^2*y\"\nforce = { x = \"-0.05*x'\", y = \"-0.05*y' + 0.3*cos(w*t)\" }\n[boundary]\n"
      "periodic = true\nduration = \"2*pi/w\"\n[guess]\nx = \"0\"\ny = \"-0.2*cos(w*t)\"\n[continuation]\n"
      "parameter = \"w\"\nto = 2.6\npoints = 100\nswitch = true\n");
  Diagram diagram(study.continuation->family,
                  {.solve = study.options, .points = 100, .other_branches = true});
  std::vector<BranchPoint> points;
  while (diagram.advance() && diagram.point().branch < 2) points.push_back(diagram.point());
  std::vector<double> doubled;
  for (const BranchPoint& point : points)
    if (point.branch == 0 && point.kind == PointKind::period_doubling) doubled.push_back(point.parameter);
  ASSERT_EQ(doubled.size(), 2u);
  EXPECT_EQ(diagram.branches()[1].end, BranchEnd::closed) << diagram.branches()[1].message;
  EXPECT_NEAR(points.back().parameter, doubled[1], 1e-7);
}

/// A driven oscillator between stops that it grazes at F = 0.6295, and beyond touches in turn: the crossings
/// come out of the turning points, and pass the end of the period. The fold by solutions of both linear
/// equations put together (x(0) = −0.5106955, x'(0) = 0.0970157 there).
TEST(BranchEvents, OrbitsThatGrazeAStop) {
  LONG_TEST();
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nparameters = { F = 0.6 }\nlagrangian = \"x'^2/2 - x^2/2 - "
      "2*max(abs(x) - "
      "0.5, 0)^2 + F*x*cos(1.5*t)\"\nforce = { x = \"-0.1*x'\" }\n[boundary]\nperiodic = true\nduration = "
      "\"2*pi/1.5\"\n[guess]\nx = \"-0.47*cos(1.5*t)\"\n[continuation]\nparameter = \"F\"\nto = 1\npoints = "
      "32\n"));
  const std::vector<double> folds = values(found.points, PointKind::fold);
  ASSERT_GE(folds.size(), 1u) << found.branches[0].message;
  EXPECT_NEAR(folds[0], 0.63523985916457, 1e-9);
}

/// x'' = −sign x has T = 4√(2E), and one degree of freedom has the multipliers 1, 1. The orbit begins on the
/// kink, which is at T too.
TEST(BranchEvents, OrbitsThatBeginOnAKink) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - abs(x)\"\n[boundary]\nperiodic = true\n"
      "duration = \"free\"\nenergy = 0.5\n[guess]\nx = \"0.5*sin(2*pi*t/T)\"\nduration = 4\n[continuation]\n"
      "parameter = \"energy\"\nto = 2\npoints = 20\n"));
  ASSERT_GT(found.points.size(), 3u);
  for (const BranchPoint& point : found.points) {
    EXPECT_NEAR(point.solution.duration(), 4 * std::sqrt(2 * point.parameter), 1e-9);
    ASSERT_TRUE(point.solution.floquet);
    for (const auto& multiplier : point.solution.floquet->multipliers)
      EXPECT_NEAR(std::abs(multiplier - 1.0), 0, 1e-6);
  }
}

/// Half waves of x and y begin at a = π², each or both: x(0)² = (8/3)(a − π²), y(0)² = (10/3)(a − π²) next to
/// it. Nothing in between is an extremal.
TEST(BranchEvents, TwoBranchesThatBeginTogether) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { a = 5 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - a*(x^2 + y^2)/2 + x^4/8 + y^4/10\"\n[boundary]\nduration = 1\n"
      "[guess]\nx = \"0\"\n[continuation]\nparameter = \"a\"\nto = 12\npoints = 10\nswitch = true\n"));
  for (const BranchPoint& point : found.points) {
    const std::vector<double>& q = point.solution.trajectory.nodes;
    if (point.branch == 0) continue;
    const double ratio = std::abs(q[1] / q[0]);
    EXPECT_TRUE(ratio < 1e-3 || ratio > 1e3 || std::abs(ratio - std::sqrt(1.25)) < 0.1) << ratio;
  }
}

/// The point of the branch at the end, by solutions of both linear equations put together: there a crossing
/// has just passed the end of the period.
TEST(BranchEvents, OrbitsThatBeginBesideAKink) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nparameters = { F = 0.3965 }\nlagrangian = \"x'^2/2 - x^2/2 - "
      "3*max(x - 0.5, 0)^2 + F*x*cos(1.3*t)\"\nforce = { x = \"-0.1*x'\" }\n[boundary]\nperiodic = true\n"
      "duration = \"2*pi/1.3\"\n[guess]\nstate = { x = 0.4974, \"x'\" = 2.615 }\n[continuation]\n"
      "parameter = \"F\"\nto = 0.398\npoints = 40\n"));
  ASSERT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  for (const BranchPoint& point : found.points) EXPECT_LT(point.momentum_difference, 1e-8) << point.parameter;
  EXPECT_NEAR(found.points.back().solution.momentum_start[0], 2.6196183977, 1e-8);
}

/// Odd about the time at which they cross the kink, 1.6e-6 of the period from where they begin.
TEST(BranchEvents, SlopesOfOrbitsThatCrossAKinkAtOnce) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nparameters = { F = 1.0 }\nlagrangian = \"x'^2/2 - 0.4*x^2/2 - "
      "0.3*abs(x) + F*x*sin(1.5*t + 1e-5)\"\n[boundary]\nperiodic = true\nduration = \"2*pi/1.5\"\n"
      "[guess]\nx = \"-0.5*sin(2*pi*t/T)\"\n[continuation]\nparameter = \"F\"\nto = 1.5\npoints = 40\n"));
  ASSERT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  for (const BranchPoint& point : found.points) {
    EXPECT_LT(point.momentum_difference, 1e-9) << point.parameter;
    EXPECT_TRUE(point.solution.floquet.has_value()) << point.parameter;
  }
}

/// x'' = −x, and −x − 1 beyond a kink: orbits begin on it, or it comes to where they do.
TEST(BranchEvents, OrbitsBeginOffKinks) {
  const double kink = 0.5;
  for (const double phase : {2.2, 0.6}) {
    const FollowedBranch found = extremal::follow(study_of(fmt::format(
        "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2 - max(x - {}, 0)\"\n[boundary]\n"
        "periodic = true\nduration = \"free\"\nenergy = 0.5\n[guess]\nx = \"0.9*sin(2*pi*t/T + {})\"\n"
        "duration = 6\n[continuation]\nparameter = \"energy\"\nto = 10\npoints = 60\n",
        kink, phase)));
    ASSERT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
    EXPECT_LT(found.points.size(), 30u);
    for (const BranchPoint& point : found.points) {
      const double square = 2 * point.parameter, beyond = square + 2 * kink + 1;
      const double period =
          2 * (pi / 2 + std::asin(kink / std::sqrt(square))) + 2 * std::acos((kink + 1) / std::sqrt(beyond));
      EXPECT_NEAR(point.solution.duration(), period, 1e-8) << point.parameter;
    }
  }
  const FollowedBranch turning = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - abs(cos(x))\"\n[boundary]\nperiodic = true\n"
      "map = { x = \"x + pi\" }\nduration = \"free\"\nenergy = 2.0\n[guess]\nx = \"pi/2 + pi*t/T\"\n"
      "duration = 2.0\n[continuation]\nparameter = \"energy\"\nto = 1.5\npoints = 25\n"));
  EXPECT_EQ(turning.branches[0].end, BranchEnd::target) << turning.branches[0].message;
}

/// Two coupled pendulums that pass the top in turn. Branch points lie next to folds, and branches of the
/// other symmetry turn there; numbers from the eigenvalues of dense second variations on 300 and 800
/// elements, in the order of events.
TEST(BranchEvents, IndexOfBranchPointsNextToFolds) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { K = 1.5 }\nlagrangian = \"(x'^2+y'^2)/2 + "
      "K*(cos(x)+cos(y)) - (x-y)^2/2\"\n[boundary]\nperiodic = true\nmap = { x = \"y\", y = \"x\" }\n"
      "duration = 2.0\n[guess]\nx = \"0.9*cos(pi*t/T)\"\ny = \"-0.9*cos(pi*t/T)\"\n[continuation]\n"
      "parameter = \"duration\"\nto = 4.0\npoints = 36\nswitch = true\n"));
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-6; };
  for (const BranchPoint& point : found.points) {
    if (point.kind == PointKind::regular) continue;
    ASSERT_TRUE(point.solution.morse_index.has_value()) << point.parameter;
    EXPECT_EQ(point.solution.nullity, 2) << point.parameter;
    for (const double with_index_one : {2.33611033, 2.25564877, 2.23917806}) {
      EXPECT_TRUE(!near(point.parameter, with_index_one) || point.solution.morse_index == 1) << point.branch;
    }
    for (const double minimal : {2.25615347, 2.17197489, 2.19905532, 2.20809741}) {
      EXPECT_TRUE(!near(point.parameter, minimal) || point.solution.morse_index == 0) << point.branch;
    }
  }
  EXPECT_GT(found.branches.size(), 8u);
}

/// A turning pendulum that a wave drives: without it orbits can be shifted in time, which is no direction of
/// those beside. Dense second variations have one negative eigenvalue from F = 0.2 to the end.
TEST(BranchEvents, AFirstMemberThatCanBeShiftedInTime) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"a\"]\nparameters = { F = 0.0, w = 2.0 }\nlagrangian = \"a'^2/2 + cos(a) + "
      "F*cos(a - w*t)\"\n[boundary]\nperiodic = true\nmap = { a = \"a + 2*pi\" }\nduration = \"2*pi/w\"\n"
      "[guess]\na = \"w*t + 0.3*sin(w*t)\"\n[continuation]\nparameter = \"F\"\nto = 1.5\npoints = 60\n"));
  ASSERT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  ASSERT_EQ(values(found.points, PointKind::period_doubling).size(), 1u);
  EXPECT_EQ(found.points[0].solution.morse_index, 0);
  EXPECT_EQ(found.points[0].solution.nullity, 1);
  for (std::size_t k = 1; k < found.points.size(); ++k)
    EXPECT_EQ(found.points[k].solution.morse_index, 1) << found.points[k].parameter;
}

/// Without its drive the oscillator's orbits can be shifted in time, and at a = 1 the potential is round:
/// branches of one value, which go all round.
TEST(BranchEvents, BranchesOfOneValueAreClosed) {
  LONG_TEST();
  const FollowedBranch shifted = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\"]\nparameters = { F = -0.2, w = 1.3 }\nlagrangian = \"x'^2/2 - x^2/2 - "
      "x^4/4 + F*x*cos(w*t)\"\n[boundary]\nperiodic = true\nduration = \"2*pi/w\"\n[guess]\nx = "
      "\"0.8*cos(w*t)\"\n[continuation]\nparameter = \"F\"\nto = 0.3\npoints = 200\nswitch = true\n[solve]\n"
      "budget = 600\n"));
  ASSERT_EQ(shifted.branches.size(), 3u);
  for (const int k : {1, 2}) {
    EXPECT_EQ(shifted.branches[k].end, BranchEnd::closed) << shifted.branches[k].message;
    EXPECT_GT(shifted.branches[k].points, 5);
  }
}

/// Great circles of a sphere in the family of equators of spheroids, along z'' = −(2π/c)² z of the period 1:
/// the index is 1, and for c < 1 it is 3. One step ends at c = 1 itself.
TEST(BranchEvents, AStepThatEndsWhereBranchesCross) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nparameters = { c = 1.3 }\nlagrangian = \"(x'^2 + "
      "y'^2 + z'^2)/2\"\nconstraints = [\"x^2 + y^2 + z^2/c^2 = 1\"]\n[boundary]\nperiodic = true\n"
      "duration = 1\n[guess]\nx = \"cos(2*pi*t)\"\ny = \"sin(2*pi*t)\"\nz = \"0\"\n[continuation]\n"
      "parameter = \"c\"\nto = 0.7\npoints = 20\n"));
  const std::vector<double> branches = values(found.points, PointKind::branch);
  ASSERT_EQ(branches.size(), 1u) << found.branches[0].message;
  EXPECT_NEAR(branches[0], 1, 1e-9);
  for (const BranchPoint& point : found.points) {
    const bool crossing = point.kind == PointKind::branch;
    EXPECT_EQ(point.solution.morse_index, crossing || point.parameter > 1 ? 1 : 3) << point.parameter;
    EXPECT_EQ(point.solution.nullity, crossing ? 3 : 1) << point.parameter;
  }
}

/// A pendulum in a plane of a sphere, which at e = 0 may be turned about the vertical; its index otherwise as
/// solves find it. The middle of a step is e = 0 itself.
TEST(BranchEvents, AStepWithACrossingInItsMiddle) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nparameters = { e = -0.2 }\nlagrangian = \"(x'^2 + "
      "y'^2 + z'^2)/2 - z - e*y^2\"\nconstraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nperiodic = true\n"
      "duration = 7.5\n[guess]\nx = \"sin(1.1)*cos(2*pi*t/T)\"\ny = \"0\"\n"
      "z = \"-sqrt(1 - sin(1.1)^2*cos(2*pi*t/T)^2)\"\n[continuation]\nparameter = \"e\"\nto = 0.3\n"
      "points = 20\n"));
  const std::vector<double> branches = values(found.points, PointKind::branch);
  ASSERT_EQ(branches.size(), 1u) << found.branches[0].message;
  EXPECT_NEAR(branches[0], 0, 1e-9);
  for (const BranchPoint& point : found.points)
    EXPECT_EQ(point.solution.morse_index, point.parameter > 1e-6 ? 4 : 3) << point.parameter;
}

/// All orbits of the harmonic oscillator have its period. Beside it the eigenvalues grow with the square of
/// the parameter: the index is known from the first point of the branch on that tells them from zero.
TEST(BranchEvents, ABranchThatBeginsAtOrbitsOfOnePeriod) {
  const FollowedBranch found = extremal::follow(study_of(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { l = 0 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
      "(x^2 + y^2)/2 - l*(x^2*y - y^3/3)\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.1\n"
      "[guess]\nx = \"0\"\ny = \"0.447*cos(t)\"\nduration = 6.3\n[continuation]\nparameter = \"l\"\n"
      "to = 0.6\npoints = 10\n"));
  ASSERT_GT(found.points.size(), 4u);
  for (std::size_t k = 1; k < found.points.size(); ++k) {
    EXPECT_EQ(found.points[k].solution.morse_index, 4) << found.points[k].parameter;
    EXPECT_EQ(found.points[k].solution.nullity, 1) << found.points[k].parameter;
  }
}

/// A drive that hardly holds the phase of large oscillations: at 1e-9 roundoff hides where it does, which is
/// told; at 1e-6 the branch is followed to its end.
TEST(BranchEvents, WhatRoundoffHidesIsTold) {
  for (const char* tolerance : {"1e-9", "1e-6"}) {
    const FollowedBranch found = extremal::follow(study_of(
        std::string("[system]\ncoordinates = [\"x\"]\nparameters = { w = 1.3673546414452946, F = 0.3 }\n"
                    "lagrangian = \"x'^2/2 - x^2/2 - x^4/4 + F*x*cos(w*t)\"\n[boundary]\nperiodic = true\n"
                    "duration = \"2*pi/w\"\n[guess]\nstate = { x = -0.014887, \"x'\" = -7.013866 }\n"
                    "[continuation]\nparameter = \"w\"\nto = 1.5\npoints = 100\n[solve]\ntolerance = ") +
        tolerance + "\n"));
    const BranchRecord& branch = found.branches.front();
    const bool told = branch.message.find("roundoff hides the") != std::string::npos;
    EXPECT_TRUE(told || branch.end == BranchEnd::target) << tolerance << ": " << branch.message;
    if (std::string_view(tolerance) == "1e-6") {
      EXPECT_EQ(branch.end, BranchEnd::target) << branch.message;
    }
    EXPECT_LT(*branch.worst_action_slope, 1e-8) << tolerance;
  }
}

}  // namespace
}  // namespace extremal::laws
