#include <algorithm>
#include <cmath>

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

class StartScanScenes : public Scenes {};

/// Between natural ends the pendulum rests, or swings from one turning point to another: with k half swings
/// in the duration T, which is longer than kπ. For T = 10, k is 1, 2 or 3, and each swing begins on either
/// side.
TEST_F(StartScanScenes, SwingsBetweenNaturalEnds) {
  const std::vector<Solution> found = run_all(
      study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + cos(x)\"\n[boundary]\nduration = 10\n"
            "[search]\nsolutions = 40\n"));
  ASSERT_FALSE(found.empty());
  int swings = 0;
  for (const Solution& s : found) {
    ASSERT_TRUE(s.converged()) << s.message;
    const double start = std::abs(s.trajectory.nodes[0]);
    EXPECT_NEAR(s.momentum_start[0], 0, 1e-8);
    EXPECT_NEAR(s.momentum_end[0], 0, 1e-8);
    swings += start > 1e-6 && start < 3.1;
  }
  EXPECT_EQ(swings, 6);
}

/// x'' = −4x³ from x'(0) = 1 to x'(T) = −1/2.
TEST_F(StartScanScenes, MomentaAtBothEnds) {
  const std::vector<Solution> found = run_all(study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^4\"\n[boundary]\nstart = { p_x = 1 }\n"
      "end = { p_x = -0.5 }\nduration = 5\n[search]\nsolutions = 40\n"));
  // As many starts within 4 as a scan with steps of 10⁻³ finds.
  EXPECT_EQ(
      std::ranges::count_if(found, [](const Solution& s) { return std::abs(s.trajectory.nodes[0]) < 4; }),
      17);
}

/// Two pendula that know nothing of each other: the extremals are all pairs of those of one. In T = 7 each
/// rests below or above, or begins one half swing or two on either side.
TEST_F(StartScanScenes, PairsOfSwings) {
  const std::vector<Solution> found =
      run_all(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + cos(x) + "
                    "cos(y)\"\n[boundary]\nduration = 7\n[search]\nsolutions = 60\n"));
  EXPECT_EQ(found.size(), 36);
}

/// A driven motion with a momentum given at either end. A scan by RK4 on 400 x 400 starts, each zero found by
/// Newton's method, has 25 with p_x(0) and y(0) in this range.
TEST_F(StartScanScenes, FixedEndsAndMomentaInTurn) {
  const std::vector<Solution> found = run_all(study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - x^4/4 - y^4/4 - x*y/2 + "
      "0.3*x*cos(t)\"\n[boundary]\nstart = { x = 0.5, p_y = 0.2 }\nend = { y = 1, p_x = -0.3 }\n"
      "duration = 4\n[search]\nsolutions = 200\n"));
  EXPECT_EQ(std::ranges::count_if(found,
                                  [](const Solution& s) {
                                    return std::abs(s.momentum_start[0]) < 2 &&
                                           std::abs(s.trajectory.nodes[1]) < 6;
                                  }),
            25);
}
