#include <algorithm>
#include <cmath>

#include "rivals/shooting.hpp"
#include "rivals/verify.hpp"
#include "scenes.hpp"
#include "study/compare.hpp"
#include "study/continued.hpp"
#include "study/inspection.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

std::string damped(const std::string& force, const std::string& boundary, const std::string& rest = "") {
  return "[system]\ncoordinates = [\"x\", \"q[3]\"]\nparameters = { c = 0.3 }\n"
         "lagrangian = \"x'^2/2 + c*x^2 + sum(i, 1, 3, q[i]'^2/2)\"\nforce = { " +
         force + " }\n[boundary]\n" + boundary + "\n" + rest;
}

const std::string both_ends = "start = { x = 1, q = \"0*i\" }\nend = { x = 0, q = [1, 2, 3] }\nduration = 2";

}  // namespace

TEST_F(Scenes, ForcesOfCoordinatesArraysAndElements) {
  const Study shared = study(damped("x = \"-x'\", q = \"-c*i*q[i]'\"", both_ends));
  const Study listed =
      study(damped("x = \"-x'\", q = [\"-c*q[1]'\", \"-c*2*q[i]'\", \"-c*i*q[3]'\"]", both_ends));
  const Study single = study(
      damped("x = \"-x'\", \"q[1]\" = \"-c*q[1]'\", \"q[2]\" = \"-2*c*q[2]'\", \"q[3]\" = \"-3*c*q[3]'\"",
             both_ends));
  const Solution a = run(shared), b = run(listed), c = run(single);
  ASSERT_TRUE(a.converged() && b.converged() && c.converged()) << a.message;
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(a.momentum_start[k], b.momentum_start[k], 1e-12);
    EXPECT_NEAR(a.momentum_start[k], c.momentum_start[k], 1e-12);
  }
  // q' = v e^{−ct}: v = c q(T)/(1 − e^{−cT})
  EXPECT_NEAR(a.momentum_start[2], 0.6 * 2 / (1 - std::exp(-1.2)), 1e-10);
}

TEST_F(Scenes, ForcesThatAreWrong) {
  const auto force = [&](const std::string& text) { return message(damped(text, both_ends)); };
  EXPECT_EQ(force("z = \"-c\""), "scene.toml:5:11: unknown coordinate 'z'; the system has x, q");
  EXPECT_EQ(force("\"x'\" = \"-c\""), "scene.toml:5:11: \"x'\" is a velocity, and a coordinate stands here");
  EXPECT_EQ(force("x = \"-c*w\"").substr(0, 36), "scene.toml:5:19: unknown name 'w'; i");
  EXPECT_EQ(force("q = [\"-c\", \"2\"]"), "scene.toml:5:15: 'q' has 3 elements; found 2 values");
  EXPECT_EQ(force("q = \"-c\", \"q[2]\" = \"-c\""),
            "scene.toml:5:21: the force on q[2] is given by 'q' already");
  EXPECT_EQ(force("q = [\"-c\", \"-c\", \"-b\"]").substr(0, 34), "scene.toml:5:30: unknown name 'b';");
  const std::string periodic = "periodic = true\nduration = \"free\"\n";
  const std::string guess = "[guess]\nx = \"cos(t)\"\nduration = 6\n";
  EXPECT_EQ(
      message(damped("x = \"-c*x'\"", periodic + "energy = 1", guess)),
      "scene.toml:9:10: with forces the energy is no constant, and the orbit has a period of its own; leave "
      "'energy' out");
  EXPECT_EQ(message(damped("x = \"-c*x'\"", periodic + "where = \"x(0) = 1\"", guess)),
            "scene.toml:9:9: with forces an orbit has a period of its own; leave 'where' out");
  EXPECT_EQ(message(damped("x = \"-c*x'\"", "start = { x = 1 }\nduration = \"free\"\nenergy = 1", guess)),
            "scene.toml:9:10: with forces the energy is no constant; close the duration by 'where'");
  EXPECT_EQ(message(damped("x = \"-c*x'\"", "start = { x = 1 }\nduration = \"free\"", guess)),
            "scene.toml:8:12: a free duration with forces needs 'where' to close it");
  EXPECT_EQ(message(damped("x = \"-c*x' + sin(t)\"", periodic, guess)),
            "scene.toml:8:12: a free duration needs a Lagrangian that does not depend on t, and forces that "
            "do not");
  EXPECT_EQ(message(damped("x = \"-c*x'\"", both_ends, "[search]\nsolutions = 3\n")).substr(0, 50),
            "scene.toml:11:13: [search] looks for extremals, an");
  EXPECT_EQ(
      message(damped("x = \"-c*x' + sin(t)\"", "periodic = true\nduration = 6", "[guess]\nx = \"cos(t)\"\n"))
          .substr(0, 74),
      "scene.toml:8:12: L does not repeat after the duration 6: the force on x ch");
}

TEST_F(Scenes, AGuessedStateMovesByTheForces) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\nforce = { x = \"-x'/2\" }\n"
      "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 2\n[guess]\nstate = { \"x'\" = 1 }\n");
  EXPECT_NEAR(s.problem.guess.q.back(), 2 * (1 - std::exp(-1)), 1e-12);
}

TEST_F(Scenes, RivalsShootMotionsWithForces) {
  const std::string system =
      "[system]\ncoordinates = [\"x\", \"y\"]\ndefinitions = { v = \"sqrt(x'^2 + y'^2)\" }\n"
      "lagrangian = \"v^2/2*(1 + x^2/10) - 3*y\"\nforce = { x = \"-v*x'/10\", y = \"-v*y'/10 + x/5\" }\n";
  const Study s =
      study(system + "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 2, y = 0.5 }\nduration = 1.5\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  const Verification found = verify(s.problem, solution.trajectory, {.tolerance = 1e-9});
  EXPECT_TRUE(found.verified) << found.message;
  for (const int segments : {1, 8}) {
    const Shot shot = shoot(s.problem, {.tolerance = 1e-10, .segments = segments});
    ASSERT_TRUE(shot.converged()) << shot.message;
    std::vector<double> q(2), v(2);
    solution.trajectory.at(0, q, v);
    EXPECT_NEAR(shot.v[0], v[0], 1e-7);
    EXPECT_NEAR(shot.v[1], v[1], 1e-7);
  }
  const Study cycle = study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\nforce = { x = \"(1 - x^2)*x'\" }\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nx = \"2*cos(2*pi*t/T)\"\nduration = 6.5\n");
  const Shot shot = shoot(cycle.problem, {.tolerance = 1e-10, .segments = 8});
  ASSERT_TRUE(shot.converged()) << shot.message;
  EXPECT_NEAR(shot.duration(), 6.663286859323, 1e-8);
}

TEST_F(Scenes, DerivativesOfForcesAreChecked) {
  const Inspection found = inspect(study(damped("x = \"-x'*q[2]\", q = \"-c*sin(q[i])*x\"", both_ends)));
  ASSERT_TRUE(found.with_forces);
  EXPECT_TRUE(found.with_forces->agree());
  EXPECT_TRUE(found.forces_autonomous);
}

/// x = e^{−ct/2}(cos wt + (c/2w) sin wt): the copies of a damped motion would part like e^{ct/2} by roundoff.
TEST_F(Scenes, ForcedMotionFromInitialData) {
  const double c = 0.8, w = std::sqrt(1 - c * c / 4);
  const std::string scene =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"(x'^2 - x^2)/2\"\n"
      "force = { x = \"-0.8*x'\" }\n[boundary]\nstart = { x = 1, p_x = 0 }\nduration = 200\n";
  const auto truth = [&](double t) {
    return std::exp(-c * t / 2) * (std::cos(w * t) + c / (2 * w) * std::sin(w * t));
  };
  for (const char* solving : {"", "[solve]\nscheme = \"gauss(4)\"\nelements = 400\n"}) {
    const Solution s = run(study(scene + solving));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_EQ(s.trajectory.coordinates, 1);
    for (const double t : {0.5, 5.0, 20.0, 200.0}) {
      double q, v;
      s.trajectory.at(t, {&q, 1}, {&v, 1});
      EXPECT_NEAR(q, truth(t), 1e-8) << t;
    }
    EXPECT_NEAR(*s.work, -0.5, 1e-9);
    EXPECT_FALSE(s.morse_index || s.energy_drift);
  }
  const Comparison comparison = compare(study(scene));
  for (const ComparisonRow& row : comparison.rows) {
    const bool precise = row.method == "dop853" && row.tolerance < 1e-10;
    EXPECT_LT(precise ? row.error.value_or(1) : 0, 1e-7);
  }
}

/// A force by |q'|, which has no derivative at rest: x'' = −k x'|x'| has the solution log(1 + k v t)/k.
TEST_F(Scenes, DragFromInitialData) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n"
      "force = { x = \"-0.5*sqrt(x'^2 + y'^2)*x'\", y = \"-0.5*sqrt(x'^2 + y'^2)*y'\" }\n"
      "[boundary]\nstart = { x = 0, y = 0, p_x = 3, p_y = 4 }\nduration = 2\n";
  const Solution s = run(study(scene));
  ASSERT_TRUE(s.converged()) << s.message;
  double q[2], v[2];
  s.trajectory.at(2, q, v);
  EXPECT_NEAR(q[0], 0.6 * std::log(1 + 0.5 * 5 * 2) / 0.5, 1e-8);
  EXPECT_NEAR(q[1], 0.8 * std::log(1 + 0.5 * 5 * 2) / 0.5, 1e-8);
}

/// The drag of a body at rest is zero, and its derivative 0/0: one element closed upon itself is no orbit.
TEST_F(Scenes, NoOrbitIsReadWhereDerivativesAreNotFinite) {
  const Solution s =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n"
                "force = { x = \"-sqrt(x'^2 + y'^2)*x'\", y = \"-sqrt(x'^2 + y'^2)*y'\" }\n"
                "[boundary]\nperiodic = true\nduration = \"free\"\n"
                "[guess]\nx = \"4 + 15*cos(2*pi*t/T)\"\ny = \"10 + 2*sin(2*pi*t/T)\"\nduration = 0.02\n"
                "[solve]\nscheme = \"simpson\"\nelements = 1\n"));
  EXPECT_FALSE(s.converged()) << s.message;
}

/// A potential written as a force: each orbit has its own period.
TEST_F(Scenes, PeriodsThatAreNotIsolated) {
  const Solution s =
      run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"(x'^2 - x^2)/2\"\n"
                "force = { x = \"-x^3\" }\n[boundary]\nperiodic = true\nduration = \"free\"\n"
                "[guess]\nx = \"cos(2*pi*t/T)\"\nduration = 5\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NE(s.message.find("its period is not isolated"), std::string::npos) << s.message;
  EXPECT_TRUE(s.floquet->stable());
}

/// Paths about these points of rest never close, though a turn of amplitude a changes it by hardly 0.8 a³.
TEST_F(Scenes, PointsOfRestWithoutDampingAreNoOrbits) {
  for (const std::string law : {"x'^2/2 - x^2/2 - x^3/3\"\nforce = { x = \"-x*x'\" }",
                                "x'^2/2 + x^2/2 - x^3/3\"\nforce = { x = \"(1 - x)*x'\" }"}) {
    const double rest = law.find("+ x^2/2") == std::string::npos ? 0 : 1;
    const Solution found =
        run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"" + law +
                  "\n[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 6.3\nx = \"" +
                  std::to_string(rest) + " + 0.3*cos(2*pi*t/T)\"\n"));
    EXPECT_EQ(found.status, Status::no_solution_near) << found.message;
    EXPECT_NE(found.message.find("the orbit shrank to a point of equilibrium"), std::string::npos);
  }
}

/// Half an orbit of van der Pol's equation with layers, closed by x -> -x: half the period that DOP853 at
/// 1e-12 has between passages of x = 1.
TEST_F(Scenes, TheMotionThatAGuessTendsToMayBeClosedByASymmetry) {
  const Solution half =
      run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\nforce = { x = \"50*(1 - "
                "x^2)*x'\" }\n"
                "[boundary]\nperiodic = true\nduration = \"free\"\nmap = { x = \"-x\" }\n"
                "[guess]\nx = \"2*cos(pi*t/T)\"\nduration = 42\n"));
  ASSERT_TRUE(half.converged()) << half.message;
  EXPECT_NEAR(half.duration(), 82.50833389 / 2, 1e-7);
}

/// The Legendre transform has the copies; where there is none the scene is refused.
TEST_F(Scenes, ForcesOfAHamiltonian) {
  const auto scene = [](const std::string& law, const std::string& rest) {
    return "[system]\ncoordinates = [\"x\", \"y\"]\n" + law +
           "\nforce = { x = \"-0.3*x' + 0.1*y\", y = \"-0.1*y'^3\" }\n[boundary]\n" + rest;
  };
  const std::string l = "lagrangian = \"(x'^2/(1 + y^2) + y'^2)/2 - x^2/2 - y^4/4\"",
                    h = "hamiltonian = \"((1 + y^2)*p_x^2 + p_y^2)/2 + x^2/2 + y^4/4\"";
  const std::string ends = "start = { x = 1, y = 0.2 }\nend = { x = -0.3, p_y = 0.1 }\nduration = 2\n",
                    initial = "start = { x = 1, p_x = 0.2, y = 0.3, p_y = -0.1 }\nduration = 5\n";
  for (const std::string& rest : {ends, initial, ends + "[solve]\nscheme = \"midpoint\"\nelements = 40\n"}) {
    const Solution of_l = run(study(scene(l, rest))), of_h = run(study(scene(h, rest)));
    ASSERT_TRUE(of_l.converged() && of_h.converged()) << of_l.message << of_h.message;
    std::vector<double> q(2), other(2), v(2);
    for (const double tau : {0.0, 0.3, 0.7, 1.0}) {
      of_l.trajectory.at(tau * of_l.duration(), q, v);
      of_h.trajectory.at(tau * of_h.duration(), other, v);
      EXPECT_NEAR(q[0], other[0], 1e-9) << rest;
      EXPECT_NEAR(q[1], other[1], 1e-9) << rest;
    }
    EXPECT_NEAR(*of_l.work, *of_h.work, 1e-8) << rest;
    EXPECT_FALSE(of_h.morse_index);
  }
  EXPECT_NE(message(scene("hamiltonian = \"x*p_x + y*p_y\"", ends)).find("scene.toml:4"), std::string::npos);
  EXPECT_NE(message(scene("hamiltonian = \"cosh(p_x) + p_y^2/2\"", ends)).find("quadratic forms"),
            std::string::npos);
}

/// Dry friction has no value at rest. Let go, a mass on a spring moves if the spring is stronger, by half
/// turns about ±c; else it stays.
TEST_F(Scenes, DryFrictionFromRest) {
  const auto scene = [](double x, double duration) {
    return fmt::format(
        "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\nforce = {{ x = "
        "\"-0.2*x'/abs(x')\" }}\n"
        "[boundary]\nstart = {{ x = {}, p_x = 0 }}\nduration = {}\n",
        x, duration);
  };
  for (const double side : {1.0, -1.0}) {
    const Solution found = run(study(scene(1.5 * side, 8)));
    ASSERT_TRUE(found.converged()) << found.message;
    std::vector<double> q(1), v(1);
    found.trajectory.at(2, q, v);
    EXPECT_NEAR(q[0], side * (0.2 + 1.3 * std::cos(2.0)), 1e-8);
    found.trajectory.at(8, q, v);
    EXPECT_NEAR(q[0], side * (0.2 + 0.5 * std::cos(8.0)), 1e-8);
  }
  for (const double x : {0.12, -0.19, 0.0}) {
    const Solution found = run(study(scene(x, 8)));
    EXPECT_FALSE(found.converged());
    EXPECT_NE(found.message.find("it stays on a kink of abs, min or max"), std::string::npos)
        << found.message;
  }
}

/// Along the family to a Hopf point no index is missed: with forces there is none.
TEST_F(Scenes, FamiliesWithForcesHaveNoIndexToMiss) {
  const FollowedBranch family = follow(study(
      "[system]\ncoordinates = [\"x\"]\nparameters = { m = 0.4 }\nlagrangian = \"x'^2/2 - x^2/2 - x^4/8\"\n"
      "force = { x = \"m*x' - x'^3/2\" }\n[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\n"
      "x = \"cos(2*pi*t/T)\"\nduration = 5.5\n[continuation]\nparameter = \"m\"\nto = -0.1\npoints = 60\n"));
  ASSERT_EQ(family.branches.size(), 1u);
  EXPECT_NE(family.branches[0].message.find("the orbits shrink onto an equilibrium"), std::string::npos);
  EXPECT_EQ(family.branches[0].message.find("Morse"), std::string::npos) << family.branches[0].message;
}

/// A softening oscillator under a drive: orbits of twice the period double again, which is told.
TEST_F(Scenes, WhatBifurcatesFromOtherBranchesIsTold) {
  const FollowedBranch family = follow(study(
      "[system]\ncoordinates = [\"x\"]\nparameters = { F = 0.08 }\n"
      "lagrangian = \"x'^2/2 + x^2/4 - x^4/8 + F*cos(0.8*t)*x\"\nforce = { x = \"-0.125*x'\" }\n[boundary]\n"
      "periodic = true\nduration = \"2*pi/0.8\"\n[guess]\nx = \"1 - 0.35*cos(0.8*t)\"\n[continuation]\n"
      "parameter = \"F\"\nto = 0.1\npoints = 60\nswitch = true\n"));
  ASSERT_EQ(family.branches.size(), 2u);
  const auto doublings = [&](int branch) {
    return std::ranges::count_if(family.points, [&](const BranchPoint& point) {
      return point.branch == branch && point.kind == PointKind::period_doubling;
    });
  };
  EXPECT_EQ(doublings(0), 1);
  EXPECT_EQ(doublings(1), 1);
  const std::string told = "what begins at its own branch points and period doublings is not followed";
  EXPECT_EQ(family.branches[0].message.find(told), std::string::npos);
  EXPECT_NE(family.branches[1].message.find(told), std::string::npos) << family.branches[1].message;
}

/// An oscillator that is four times as stiff on one side: beyond the fold of its resonance at half the
/// frequency the orbit leaves x = 0, which it has crossed more often before. The folds are those of the
/// return map, integrated from crossing to crossing, where one of its multipliers is 1.
TEST_F(Scenes, ResponsesGrazeKinksWhereForcesDoNotJump) {
  const FollowedBranch family = follow(study(
      "[system]\ncoordinates = [\"x\"]\nparameters = { w = 0.48 }\n"
      "lagrangian = \"x'^2/2 - x^2/2 - 3*max(0, x)^2/2 + 0.3*cos(w*t)*x\"\nforce = { x = \"-0.1*x'\" }\n"
      "[boundary]\nperiodic = true\nduration = \"2*pi/w\"\n[guess]\nx = \"0.3*cos(w*t)\"\n[continuation]\n"
      "parameter = \"w\"\nto = 0.3\npoints = 200\n"));
  std::vector<double> folds;
  for (const BranchPoint& point : family.points)
    if (point.kind == PointKind::fold) folds.push_back(point.parameter);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0], 0.45222126100, 1e-9);
  EXPECT_NEAR(folds[1], 0.46078471509, 1e-9);
  EXPECT_EQ(family.points.back().parameter, 0.3);
}

/// Where canards of van der Pol's oscillator explode, the period grows as the number that varies hardly does,
/// and orbits rest next to an equilibrium: a source, to which no orbit is homoclinic. Beyond are the cycles
/// that shrink onto it at a = 1.
TEST_F(Scenes, ExplodingCanardsAreNotHomoclinic) {
  LONG_TEST();
  const auto canards = [&](const std::string& tolerance) {
    return follow(
        study("[system]\ncoordinates = [\"x\"]\nparameters = { a = 0.0 }\nlagrangian = \"x'^2/2 - x^2/2\"\n"
              "force = { x = \"5*(1 - x^2)*x' + a\" }\n[boundary]\nperiodic = true\nduration = \"free\"\n"
              "[guess]\nx = \"2*cos(2*pi*t/T)\"\nduration = 11.6\n[solve]\ntolerance = " +
              tolerance + "\n[continuation]\nparameter = \"a\"\nto = 1.1\npoints = 200\n"));
  };
  const FollowedBranch exact = canards("1e-9"), coarse = canards("1e-6");
  EXPECT_EQ(exact.branches[0].end, BranchEnd::too_short) << exact.branches[0].message;
  EXPECT_NEAR(exact.points.back().parameter, 0.9948377923, 1e-9);
  EXPECT_EQ(coarse.branches[0].end, BranchEnd::rest) << coarse.branches[0].message;
  EXPECT_NEAR(coarse.points.back().parameter, 1, 1e-6);
}
