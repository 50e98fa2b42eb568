#include <cmath>

#include "rivals/shooting.hpp"
#include "rivals/verify.hpp"
#include "scenes.hpp"
#include "study/compare.hpp"
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
  EXPECT_EQ(force("\"x'\" = \"-c\"").substr(0, 40), "scene.toml:5:11: unknown coordinate 'x''");
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
