#include <cmath>
#include <numbers>

#include "scenes.hpp"

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
