#include <cmath>
#include <numbers>

#include "scenes.hpp"
#include "study/continued.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

const std::string half_period =
    "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\n[boundary]\nstart = { x = 1 "
    "}\nduration = \"pi\"\n";

}  // namespace

class FamiliesBetweenEnds : public Scenes {};

TEST_F(FamiliesBetweenEnds, TheMemberNearestToTheGuess) {
  const Solution found = run(study(half_period + "end = { x = -1 }\n[guess]\nx = \"cos(t) + 0.7*sin(t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 1);
  EXPECT_EQ(found.morse_index, 0);
  EXPECT_NE(found.message.find("family"), std::string::npos);
  EXPECT_NEAR(found.momentum_start[0], 0.7, 1e-8);
}

TEST_F(FamiliesBetweenEnds, WithoutAGuessTheOneNearestToTheLine) {
  const Solution found = run(study(half_period + "end = { x = -1 }\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.momentum_start[0], 0, 1e-8);
}

/// From x = 1 to rest at the saddle x = 0, where it stays: momentum −√(3/2), action (2/3)(√(27/8) − 1). The
/// energy, which falls like exp(−2T), soon tells durations apart no more, nor do the ends.
TEST_F(FamiliesBetweenEnds, RestsForEverLongerAtASaddle) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + x^2/2 + x^4/4\"\n[boundary]\n"
      "start = { x = 1 }\nduration = 8\n[continuation]\nparameter = \"duration\"\nto = 60\npoints = 60\n");
  const FollowedBranch family = follow(s);
  ASSERT_FALSE(family.points.empty());
  EXPECT_NEAR(family.points.back().parameter, 60, 1e-9) << family.branches.front().message;
  for (const BranchPoint& point : family.points) {
    if (point.parameter < 20) continue;
    EXPECT_NEAR(point.solution.momentum_start[0], -std::sqrt(1.5), 1e-8) << point.parameter;
    EXPECT_NEAR(point.solution.action, (std::sqrt(27.0 / 8) - 1) * 2 / 3, 1e-10) << point.parameter;
  }
}

TEST_F(FamiliesBetweenEnds, ConjugateEndsWithoutExtremals) {
  const Solution found = run(study(half_period + "end = { x = -0.5 }\n"));
  EXPECT_EQ(found.status, Status::conjugate_ends);
}

TEST_F(FamiliesBetweenEnds, GreatCirclesBetweenAntipodes) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"2*(x'^2 + y'^2)/(1 + x^2 + y^2)^2\"\n"
                "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = -1, y = 0 }\nduration = 1\n"
                "[guess]\nx = \"cos(pi*t)\"\ny = \"0.5*sin(pi*t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 1);
  EXPECT_NEAR(found.action, std::numbers::pi * std::numbers::pi / 2, 1e-9);
}

TEST_F(FamiliesBetweenEnds, TwoDirectionsOfAnIsotropicOscillator) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2 - x^2 - y^2)/2\"\n"
                "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = -1, y = 0 }\nduration = \"pi\"\n"
                "[guess]\nx = \"cos(t) + 0.2*sin(t)\"\ny = \"0.5*sin(t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 2);
  EXPECT_NEAR(found.momentum_start[0], 0.2, 1e-8);
  EXPECT_NEAR(found.momentum_start[1], 0.5, 1e-8);
}

TEST_F(FamiliesBetweenEnds, NaturalEnds) {
  const std::string natural =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2 + LOAD\"\n[boundary]\nduration = "
      "\"pi\"\n"
      "[guess]\nx = \"0.7*cos(t) + 0.3*sin(5*t) + 0.2*t\"\n";
  const auto with = [&](const char* load) {
    std::string text = natural;
    return text.replace(text.find("LOAD"), 4, load);
  };
  const Solution found = run(study(with("x*cos(3*t)")));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 1);
  EXPECT_EQ(found.morse_index, 1);
  // x = A cos t − cos(3t)/8 with ∫ (guess − x) cos t dt = 0.
  EXPECT_NEAR(found.trajectory.nodes[0], 0.7 - 0.8 / std::numbers::pi - 0.125, 1e-8);
  EXPECT_NE(found.message.find("one of a family"), std::string::npos) << found.message;
  // A force along cos t, which no natural path takes up.
  EXPECT_EQ(run(study(with("x*cos(t)"))).status, Status::conjugate_ends);
}

TEST_F(FamiliesBetweenEnds, CoupledEnds) {
  const std::string coupled =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\n[boundary]\nduration = \"pi\"\n";
  const Solution found = run(study(coupled + "conditions = [\"x(0) + x(T) = 0\"]\n[guess]\nx = \"1 + t\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 2);
  EXPECT_EQ(run(study(coupled + "conditions = [\"x(0) + x(T) = 1\"]\n")).status, Status::conjugate_ends);
}

TEST_F(FamiliesBetweenEnds, ShiftsOfAFreeParticle) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nduration = "
                "2\n[guess]\nx = \"exp(t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.trajectory.nodes[0], (std::exp(2) - 1) / 2, 1e-8);
}

TEST_F(FamiliesBetweenEnds, RestAtAnExtremalOfAPendulumIsAlone) {
  const Solution found = run(study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + cos(x)\"\n[boundary]\nduration = \"pi\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.message.find("family"), std::string::npos) << found.message;
}

TEST_F(FamiliesBetweenEnds, WithForces) {
  const std::string forced =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\nforce = { x = \"FORCE\" "
      "}\n[boundary]\nstart "
      "= { x = 0 }\nend = { x = 0 }\nduration = \"pi\"\n";
  const auto with = [&](const char* force) {
    std::string text = forced;
    return text.replace(text.find("FORCE"), 5, force);
  };
  const Solution found = run(study(with("sin(2*t)")));
  ASSERT_TRUE(found.converged()) << found.message;
  // x = −sin(2t)/3, to which sin t is orthogonal.
  EXPECT_NEAR(found.momentum_start[0], -2.0 / 3, 1e-8);
  EXPECT_EQ(run(study(with("sin(t)"))).status, Status::conjugate_ends);
}

/// From the guess steps lead to the member on the other side of the centre, which is the farthest.
TEST_F(FamiliesBetweenEnds, TheNearestAndNotTheFarthest) {
  const Solution found = run(study(
      "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\ndefinitions = { s = \"x^2 + y^2 + z^2\" }\n"
      "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 - s/2 - s^2/4\"\n[boundary]\nstart = { x = 1, y = 0, z = 0 }\n"
      "end = { x = -1, y = 0, z = 0 }\nduration = \"pi/sqrt(2)\"\n[guess]\nx = \"1 - 2*t/T\"\n"
      "y = \"0.5*sin(pi*t/T)\"\nz = \"0.4*sin(2*pi*t/T)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.nullity, 1);
  EXPECT_NEAR(found.momentum_start[1], std::numbers::sqrt2, 1e-8);
  EXPECT_NEAR(found.momentum_start[2], 0, 1e-8);
}

TEST_F(FamiliesBetweenEnds, AKinkThatPassesAnEnd) {
  // From a < 0 the motion to −1 is a + v t + t²/2 with v = −(2.125 + a)/1.5.
  const FollowedBranch found = follow(
      study("[system]\ncoordinates = [\"x\"]\nparameters = { a = 0.5 }\nlagrangian = \"x'^2/2 - abs(x)\"\n"
            "[boundary]\nstart = { x = \"a\" }\nend = { x = -1 }\nduration = 1.5\n[continuation]\n"
            "parameter = \"a\"\nto = -0.5\npoints = 60\n"));
  EXPECT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  EXPECT_NEAR(found.points.back().solution.action, -1.18229166666667, 1e-9);
}

TEST_F(FamiliesBetweenEnds, AMotionWhoseVelocityCrossesAKink) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"s\", \"z\"]\nparameters = { mu = 0.3 }\n"
                "lagrangian = \"s'^2/2 + z'^2/2 - s^2/2 - z^2/2 - s*z - mu*abs(s')\"\n[boundary]\n"
                "start = { s = 1.0, z = 0.0, p_s = -0.3, p_z = 0.1 }\nduration = 6.0\n"));
  EXPECT_FALSE(found.converged());
  EXPECT_NE(found.message.find("a velocity crosses a kink of abs, min or max"), std::string::npos)
      << found.message;
}
