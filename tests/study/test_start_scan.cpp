#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

class StartScanScenes : public Scenes {
 protected:
  /// Of one coordinate x, from a guess.
  std::vector<Solution> periodic_orbits(const std::string& lagrangian, const std::string& duration,
                                        const std::string& guess, int most) {
    return run_all(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"" + lagrangian +
                         "\"\n[boundary]\nperiodic = true\nduration = \"" + duration + "\"\n[guess]\nx = \"" +
                         guess + "\"\n[search]\nsolutions = " + std::to_string(most) + "\n"));
  }
};

/// Between natural ends the pendulum rests, or swings from one turning point to another: with k half swings
/// in the duration T, which is longer than kπ. For T = 10, k is 1, 2 or 3, and each swing begins on either
/// side.
TEST_F(StartScanScenes, SwingsBetweenNaturalEnds) {
  LONG_TEST();
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
  LONG_TEST();
  const std::vector<Solution> found =
      run_all(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + cos(x) + "
                    "cos(y)\"\n[boundary]\nduration = 7\n[search]\nsolutions = 60\n"));
  EXPECT_EQ(found.size(), 36);
}

/// A driven motion with a momentum given at either end. A scan by RK4 on 400 x 400 starts, each zero found by
/// Newton's method, has 25 with p_x(0) and y(0) in this range.
TEST_F(StartScanScenes, FixedEndsAndMomentaInTurn) {
  LONG_TEST();
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

/// Velocities are less than 1, momenta are not. A scan of p(0) between -40 and 40 by RK4, each change of sign
/// halved until it is known, finds these.
TEST_F(StartScanScenes, MomentaOfBoundedVelocities) {
  LONG_TEST();
  const std::vector<Solution> found = run_all(
      study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"-sqrt(1 - x'^2) + 2*cos(x)\"\n[boundary]\n"
            "start = { x = 0.3 }\nend = { x = 1 }\nduration = 8\n[search]\nsolutions = 40\n"));
  std::vector<double> momenta;
  for (const Solution& s : found) momenta.push_back(s.momentum_start[0]);
  std::ranges::sort(momenta);
  const std::vector<double> expected{-4.5415874, -3.0630596, 1.7119598, 2.1976913, 4.7989574};
  ASSERT_EQ(momenta.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(momenta[k], expected[k], 1e-6);
}

/// x(6) of x'' = -2 sign(x) from 0.3: parabolas between zeros of x.
double end_between_kinks(double p) {
  double x = 0.3, left = 6, side = 1;
  for (;; side = -side) {
    const double until_zero = (side * p + std::sqrt(p * p + 4 * std::abs(x))) / 2;
    if (until_zero >= left) return x + p * left - side * left * left;
    left -= until_zero;
    p -= 2 * side * until_zero;
    x = 0;
  }
}

TEST_F(StartScanScenes, MotionsAcrossKinks) {
  const std::vector<Solution> found =
      run_all(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - 2*abs(x)\"\n[boundary]\n"
                    "start = { x = 0.3 }\nend = { x = -0.2 }\nduration = 6\n[search]\nsolutions = 40\n"));
  int expected = 0;
  for (int k = -20000; k < 20000; ++k)
    expected += (end_between_kinks(k * 1e-3) < -0.2) != (end_between_kinks((k + 1) * 1e-3) < -0.2);
  EXPECT_EQ(expected, 11);
  EXPECT_EQ(static_cast<int>(found.size()), expected);
  for (const Solution& s : found) EXPECT_NEAR(end_between_kinks(s.momentum_start[0]), -0.2, 1e-6);
}

/// A wave drives the pendulum: a scan of p(0) by RK4 has seven, two of them next to each other.
TEST_F(StartScanScenes, MotionsInAWave) {
  const std::vector<Solution> found = run_all(study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + cos(x) + 0.5*cos(x - 1.5*t)\"\n[boundary]\n"
      "start = { x = 0.3 }\nend = { x = 2 }\nduration = 10\n[search]\nsolutions = 40\n"));
  EXPECT_EQ(found.size(), 7);
}

/// Orbits of a driven pendulum that swing less than a half turn, as Newton's method from starts on a lattice
/// has them: two are images of each other under the reversal of time, two under that of x half a period
/// later. Less action have those that stand, or swing over the top and back.
TEST_F(StartScanScenes, DrivenPeriodicOrbits) {
  LONG_TEST();
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 + cos(x) + 0.4*x*cos(2*pi*t/14)", "14", "0.1*cos(2*pi*t/14)", 30);
  std::vector<double> swings;
  for (const Solution& s : found)
    if (s.action > 12) swings.push_back(s.action);
  const std::vector<double> expected{14.5381, 14.5381, 14.5419, 14.5419, 14.7160};
  ASSERT_EQ(swings.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(swings[k], expected[k], 1e-4);
  EXPECT_NEAR(found.front().action, -7.4771, 1e-4);
}

/// Three periods of a driven double well: chaos, in which RK4 and Newton's method from 60 x 60 starts know
/// eleven orbits, as (x, x') at their start. Each is found, at one of the three periods it may begin in.
TEST_F(StartScanScenes, OrbitsInChaos) {
  LONG_TEST();
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 + x^2/2 - x^4/4 + 0.3*x*cos(1.2*t)", "6*pi/1.2", "0.1*cos(1.2*t)", 60);
  constexpr double known[][2] = {
      {-1.2039, 0},      {0.3679, 0},  {-1.1530, 0}, {-1.5411, 0}, {-0.6168, 0}, {0.2549, -0.4348},
      {0.2145, -0.3011}, {-1.5250, 0}, {0.8561, 0},  {0.6995, 0},  {1.9439, 0},
  };
  for (const auto& start : known) {
    const bool there = std::ranges::any_of(found, [&](const Solution& s) {
      for (int period = 0; period < 3; ++period) {
        std::vector<double> q(1), slope(1);
        s.trajectory.at(period * s.duration() / 3, q, slope);
        if (std::hypot(q[0] - start[0], slope[0] - start[1]) < 1e-3) return true;
      }
      return false;
    });
    EXPECT_TRUE(there) << start[0] << ", " << start[1];
  }
  EXPECT_GE(found.size(), 30);
}

/// With two coordinates, each driven, the box of starts has four dimensions. All orbits differ in action.
TEST_F(StartScanScenes, DrivenOrbitsInThePlane) {
  LONG_TEST();
  const std::vector<Solution> found = run_all(
      study("[system]\ncoordinates = [\"x\", \"y\"]\n"
            "lagrangian = \"(x'^2+y'^2)/2 - (x^2+2*y^2)/2 - x^4/4 - x*y^2/2 - y^4/8 + 0.7*x*cos(1.3*t) + "
            "0.3*y*sin(1.3*t)\"\n[boundary]\nperiodic = true\nduration = \"2*pi/1.3\"\n"
            "[guess]\nx = \"0.3*cos(1.3*t)\"\ny = \"0.1*sin(1.3*t)\"\n[search]\nsolutions = 10\n"));
  EXPECT_GE(found.size(), 5);
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_TRUE(found[k].converged());
    for (std::size_t j = 0; j < k; ++j) EXPECT_GT(std::abs(found[k].action - found[j].action), 1e-6);
  }
}

/// A pendulum that is driven weakly hangs or stands: by whole turns, and the action that the drive gives a
/// turn, these are the same. The guess hangs.
TEST_F(StartScanScenes, TurnsOfAnAngleAreOneOrbit) {
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 + 0.9*cos(x) + 0.2*x*cos(1.7*t)", "2*pi/1.7", "0.1 + 0.2*cos(1.7*t)", 8);
  ASSERT_EQ(found.size(), 2);
  EXPECT_NE(found[0].morse_index, found[1].morse_index);
}

/// From a guess of a tenth of their size the resonant orbits of Duffing's oscillator are found, images of
/// each other under the reversal of time. A scan with RK4 of 400 x 400 starts has their action, of others
/// that begin at rest, to four digits.
TEST_F(StartScanScenes, OrbitsFarBeyondTheGuess) {
  LONG_TEST();
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 - (1.2551*x^2/2 + 0.9748*x^4/4) + 0.6722*x*cos(1.1314*t)", "2*pi/1.1314",
                      "0.1 + 0.2*cos(1.1314*t)", 3);
  ASSERT_EQ(found.size(), 3);
  EXPECT_NEAR(found[1].action, 13.9167, 1e-4);
  EXPECT_NEAR(found[2].action, 13.9167, 1e-4);
}

/// An orbit of twice the period of the drive is one with its image a period later. A scan with RK4 of 400 x
/// 400 starts has five of amplitude below 3 that are not.
TEST_F(StartScanScenes, ImagesAPeriodLaterAreOneOrbit) {
  LONG_TEST();
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 - (0.6483*x^2/2 + 0.2674*x^4/4) + 0.6432*x*cos(1.7925*t)", "2*2*pi/1.7925",
                      "0.1 + 0.2*cos(1.7925*t)", 13);
  EXPECT_GE(found.size(), 5);
  std::vector<double> q(1), v(1);
  for (const Solution& a : found)
    for (const Solution& b : found) {
      if (&a == &b) continue;
      b.trajectory.at(b.duration() / 2, q, v);
      EXPECT_GT(std::abs(a.trajectory.nodes[0] - q[0]) + std::abs(a.trajectory.slopes[0] - v[0]), 1e-3);
    }
}

/// The same where the image a period later is whole turns of an angle away: a pendulum whose pivot shakes.
TEST_F(StartScanScenes, ImagesAPeriodLaterAndTurnsApartAreOneOrbit) {
  LONG_TEST();
  const std::vector<Solution> found =
      periodic_orbits("x'^2/2 + cos(x) + 0.6*cos(x)*cos(2.1*t)", "4*pi/2.1", "0.5*cos(1.05*t)", 8);
  ASSERT_FALSE(found.empty());
  std::vector<double> q(1), v(1);
  for (const Solution& a : found)
    for (const Solution& b : found) {
      if (&a == &b) continue;
      for (const double later : {0.0, b.duration() / 2}) {
        b.trajectory.at(later, q, v);
        const double turns = std::remainder(a.trajectory.nodes[0] - q[0], 2 * std::numbers::pi);
        EXPECT_GT(std::abs(turns) + std::abs(a.trajectory.slopes[0] - v[0]), 1e-3);
      }
    }
}
