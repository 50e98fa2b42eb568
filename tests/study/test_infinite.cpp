#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

std::string scene_of(const std::string& coordinates, const std::string& lagrangian,
                     const std::string& boundary, const std::string& guess = "") {
  return "[system]\ncoordinates = " + coordinates + "\nlagrangian = \"" + lagrangian + "\"\n[boundary]\n" +
         boundary + "duration = \"infinite\"\n" + guess;
}

const std::string one = "[\"x\"]", well = "x'^2/2 + (x^2 - 1)^2/4";
const double kink = 2 * std::sqrt(2.0) / 3;

}  // namespace

class InfiniteEndsOf : public Scenes {
 protected:
  Solution solved(const std::string& content) { return run(study(content)); }
};

TEST_F(InfiniteEndsOf, KinksHaveTheirExactActions) {
  struct Case {
    std::string lagrangian, boundary;
    double action, start, end;
  };
  const Case cases[] = {
      {well, "start = { x = -1 }\nend = { x = 1 }\n", kink, std::sqrt(2.0), std::sqrt(2.0)},
      {"x'^2/2 + cos(x)", "start = { x = \"-pi\" }\nend = { x = \"pi\" }\n", 8, 1, 1},
      {"x'^2/2 + x^2*(x^2 - 1)^2/2", "start = { x = 0 }\nend = { x = 1 }\n", 0.25, 1, 2},
      {"(x' - x + x^3)^2/2", "start = { x = -1 }\nend = { x = 0 }\n", 0.5, 2, 1},
  };
  for (const Case& c : cases) {
    const Solution found = solved(scene_of(one, c.lagrangian, c.boundary));
    ASSERT_TRUE(found.converged()) << c.lagrangian << ": " << found.message;
    EXPECT_NEAR(found.action, c.action, 1e-10) << c.lagrangian;
    EXPECT_EQ(found.morse_index, 0) << c.lagrangian;
    EXPECT_EQ(found.nullity, 1) << c.lagrangian;
    EXPECT_TRUE(found.minimizing) << c.lagrangian;
    ASSERT_TRUE(found.rates && found.rates->start && found.rates->end);
    EXPECT_NEAR(*found.rates->start, c.start, 1e-12);
    EXPECT_NEAR(*found.rates->end, c.end, 1e-12);
  }
}

/// x = e^{−t}/2, and of x'²/2 + 1 − cos x the same momentum p = −2 sin(x/2); S = ∫ p dx.
TEST_F(InfiniteEndsOf, GivenMomentaBeginTheDefaultGuess) {
  const std::string from = "start = { p_x = -0.5 }\nend = { x = 0 }\n";
  const Solution linear = solved(scene_of(one, "x'^2/2 + x^2/2", from));
  ASSERT_TRUE(linear.converged()) << linear.message;
  EXPECT_NEAR(linear.trajectory.nodes[0], 0.5, 1e-9);
  EXPECT_NEAR(linear.action, 0.125, 1e-10);
  const Solution pendulum = solved(scene_of(one, "x'^2/2 + 1 - cos(x)", from));
  ASSERT_TRUE(pendulum.converged()) << pendulum.message;
  EXPECT_NEAR(pendulum.trajectory.nodes[0], 2 * std::asin(0.25), 1e-9);
  EXPECT_NEAR(pendulum.action, 4 * (1 - std::sqrt(15.0) / 4), 1e-10);
}

/// H is 0 on the path: S = ∫ p dx = ∫ √((2 − cos x)² − 1) dx = 4 + 2π. The velocity stays below 1.
TEST_F(InfiniteEndsOf, TheDefaultGuessKeepsToVelocitiesThatAreAllowed) {
  const Solution found = solved(
      "[system]\ncoordinates = [\"x\"]\nhamiltonian = \"sqrt(1 + p_x^2) - 2 + cos(x)\"\n[boundary]\n"
      "start = { x = 0 }\nend = { x = \"2*pi\" }\nduration = \"infinite\"\n");
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, 4 + 2 * std::numbers::pi, 1e-9);
}

/// 2π is rounded, so that the second derivative there is 1e-32 in place of 0; and where one end alone has λ =
/// 0, the energy of rest lets no motion pass it.
TEST_F(InfiniteEndsOf, EndsThatAreApproachedAlgebraicallyAreRefused) {
  for (const auto& [lagrangian, boundary] :
       {std::pair("x'^2/2 + (1 - cos(x))^2/2", "start = { x = 0 }\nend = { x = \"2*pi\" }\n"),
        std::pair("x'^2/2 + (1 - cos(x))^2/2", "start = { x = \"2*pi\" }\nend = { x = \"4*pi\" }\n"),
        std::pair("x'^2/2 + x^4*(1 - x)^2/2", "start = { x = 0 }\nend = { x = 1 }\n"),
        std::pair("x'^2/2 + x^2*(1 - x)^4/2", "start = { x = 0 }\nend = { x = 1 }\n")}) {
    const std::string text = message(scene_of(one, lagrangian, boundary));
    EXPECT_NE(text.find("is not approached exponentially in all directions"), std::string::npos)
        << lagrangian << ": " << text;
  }
}

TEST_F(InfiniteEndsOf, AHomoclinicOrbitIsASaddleOfTheAction) {
  const Solution found =
      solved(scene_of(one, "x'^2/2 + x^2/2 - x^4/4", "start = { x = 0 }\nend = { x = 0 }\n",
                      "[guess]\nx = \"1/cosh(t - T/2)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, 4.0 / 3, 1e-10);
  EXPECT_EQ(found.morse_index, 1);
  EXPECT_EQ(found.nullity, 1);
  EXPECT_FALSE(found.minimizing);
}

TEST_F(InfiniteEndsOf, HalfLines) {
  // dS/dx = sqrt(2V) along the motions that come to rest.
  const Solution to = solved(scene_of(one, well, "start = { x = 0.5 }\nend = { x = 1 }\n"));
  ASSERT_TRUE(to.converged()) << to.message;
  EXPECT_NEAR(to.action, kink / 2 - (0.5 - 0.125 / 3) / std::sqrt(2.0), 1e-10);
  EXPECT_EQ(to.nullity, 0);
  EXPECT_FALSE(to.rates->start.has_value());
  const Solution from = solved(scene_of(one, well, "start = { x = 1 }\nend = { x = 3 }\n"));
  ASSERT_TRUE(from.converged()) << from.message;
  EXPECT_NEAR(from.action, (26.0 / 3 - 2) / std::sqrt(2.0), 1e-9);
  // The unstable equilibrium at the start is passed at a finite time.
  const Solution half = solved(scene_of(one, well, "start = { x = 0 }\nend = { x = 1 }\n"));
  ASSERT_TRUE(half.converged()) << half.message;
  EXPECT_NEAR(half.action, kink / 2, 1e-10);
}

TEST_F(InfiniteEndsOf, TheActionIsThatBeyondRest) {
  // A constant and a total derivative in L change the action of rest and the momenta.
  const Solution found =
      solved(scene_of(one, well + " + 3.5 + 0.25*x'", "start = { x = -1 }\nend = { x = 1 }\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, kink + 0.5, 1e-10);
  EXPECT_NEAR(*found.energy, -3.5, 1e-10);
}

/// x'' + c x' = x³ − x: rates (c ± √(c² + 8))/2. The slope at t = 0 for c = 3 by collocation with the exact
/// stable direction at the end (scipy's solve_bvp, 1e-11).
TEST_F(InfiniteEndsOf, DampingTurnsRates) {
  for (const double c : {-0.5, 0.1, 1.0, 3.0}) {
    const Solution found = solved(
        scene_of(one, fmt::format("exp({}*t)*({})", c, well), "start = { x = 0.2 }\nend = { x = 1 }\n"));
    ASSERT_TRUE(found.converged()) << c << ": " << found.message;
    EXPECT_NEAR(*found.rates->end, (c + std::sqrt(c * c + 8)) / 2, 1e-8) << c;
    std::vector<double> q(1), v(1);
    found.trajectory.at(0, q, v);
    if (c == 3) {
      EXPECT_NEAR(v[0], 2.63448147075, 1e-9);
    }
  }
}

TEST_F(InfiniteEndsOf, BouncesInThreeDimensions) {
  // Linde, Nucl. Phys. B 216 (1983) 421: S3 = 4.85/δ² of the potential φ²/2 − δ φ³.
  const Solution found = solved(scene_of("[\"f\"]", "t^2*(f'^2/2 + f^2/2 - f^3/3)", "end = { f = 0 }\n",
                                         "[guess]\nf = \"6/cosh(t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(4 * std::numbers::pi * found.action, 43.660237, 2e-4);
  EXPECT_EQ(found.morse_index, 1);
}

TEST_F(InfiniteEndsOf, BouncesInOtherDimensions) {
  // Values by shooting; 2 π² times that in four dimensions is 204.42844.
  const std::pair<int, double> actions[] = {{2, 1.23357704}, {4, 10.35646592}, {5, 27.32063820}};
  for (const auto& [n, action] : actions) {
    const Solution found = solved(scene_of("[\"f\"]", fmt::format("t^{}*(f'^2/2 + f^2/2 - f^3/3)", n - 1),
                                           "end = { f = 0 }\n", "[guess]\nf = \"6/cosh(t)\"\n"));
    ASSERT_TRUE(found.converged()) << n << ": " << found.message;
    EXPECT_NEAR(found.action, action, 2e-8) << n;
    EXPECT_EQ(found.morse_index, 1) << n;
    EXPECT_EQ(found.nullity, 0) << n;
  }
}

/// At r = 0 the mass is zero, a power of r that is no whole number between these dimensions.
TEST_F(InfiniteEndsOf, BouncesFromDimensionToDimension) {
  std::string scene = scene_of("[\"f\"]", "t^(n - 1)*(f'^2/2 + f^2/2 - f^3/3)", "end = { f = 0 }\n",
                               "[guess]\nf = \"6/cosh(t)\"\n[continuation]\nparameter = \"n\"\nto = 3\n"
                               "points = 20\n");
  scene.replace(scene.find("lagrangian"), 0, "parameters = { n = 4.0 }\n");
  const FollowedBranch branch = follow(study(scene));
  EXPECT_EQ(branch.branches.front().end, BranchEnd::target) << branch.branches.front().message;
  EXPECT_NEAR(branch.points.back().solution.action, 3.474371245, 1e-8);
  for (const BranchPoint& point : branch.points) EXPECT_EQ(point.solution.morse_index, 1) << point.parameter;
}

/// x = tanh t along y = 0, whose second variation by y is −∂² + s² − 2/cosh² t: walls with y ≠ 0 begin at s
/// = 1.
TEST_F(InfiniteEndsOf, AFamilyGoesOnWhereAnotherOneBegins) {
  std::string scene = scene_of(R"(["x", "y"])", "(x'^2 + y'^2)/2 + (x^2 + y^2 - 1)^2/2 + s^2*y^2/2",
                               "start = { x = -1.0, y = 0.0 }\nend = { x = 1.0, y = 0.0 }\n",
                               "[continuation]\nparameter = \"s\"\nto = 0.6\npoints = 60\n");
  scene.replace(scene.find("lagrangian"), 0, "parameters = { s = 1.25 }\n");
  const FollowedBranch branch = follow(study(scene));
  const BranchRecord& record = branch.branches.front();
  EXPECT_LT(branch.points.back().parameter, 0.65) << record.message;
  EXPECT_NE(record.message.find("the index changes"), std::string::npos) << record.message;
  for (const BranchPoint& point : branch.points) {
    EXPECT_NEAR(point.solution.action, 4.0 / 3, 1e-9) << point.parameter;
    if (std::abs(point.parameter - 1) < 1e-3) continue;
    EXPECT_EQ(point.solution.morse_index, point.parameter < 1 ? 1 : 0) << point.parameter;
  }
}

TEST_F(InfiniteEndsOf, AreRefusedWhereTheyCannotBe) {
  const auto refused = [&](const std::string& content, const std::string& part) {
    const std::string text = message(content);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  refused(scene_of(one, "x'^2/2 - x^2/2", "start = { x = 0 }\nend = { x = 0.5 }\n"), "±1i");
  refused(scene_of(one, well, "end = { x = 0.9 }\n"), "the nearest one is x = 1; give that at the start, or");
  refused(scene_of(one, well, "start = { x = 0.9 }\n"), "the nearest one is x = 1; give that at the end, or");
  refused(scene_of(one, well, "start = { x = 0.5 }\nend = { x = 0.9 }\n"),
          "the nearest one is x = 1; give that, or");
  refused(scene_of(one, well, "start = { x = 1 }\n"), "give the end a place away from it, or a guess");
  refused(scene_of(one, well, "start = { x = -1 }\nend = { x = -1 }\n"),
          "the default guess is the equilibrium");
  refused(scene_of(one, "x'^2/2 + x^4/4 - 4*x^3/9 + x^2/6", "start = { x = 0 }\nend = { x = 1 }\n"),
          "energy of rest");
  refused(scene_of(one, well, ""), "every coordinate is fixed");
  refused(scene_of(one, well, "start = { x = -1 }\nend = { x = 1 }\n", "[search]\nsolutions = 3\n"),
          "search");
}

TEST_F(InfiniteEndsOf, RestIsNoResult) {
  const Solution found =
      solved(scene_of(one, "x'^2/2 + x^2/2 + x^4/4", "start = { x = 0 }\nend = { x = 0 }\n",
                      "[guess]\nx = \"1/cosh(t - T/2)\"\n"));
  EXPECT_FALSE(found.converged());
}

/// W = x − x³/3 − k x y² with V = |∇W|²/2 (Bazeia): all walls from (−1, 0) to (1, 0) have the action
/// W(1, 0) − W(−1, 0) = 4/3 and minimise. x = tanh(2kt), y = √(1/k − 2)/cosh(2kt) is one of them.
TEST_F(InfiniteEndsOf, OneOfAFamilyOfWallsIsTheNearestToTheGuess) {
  for (const double k : {0.3, 0.42}) {
    const double rate = 2 * k, height = std::sqrt(1 / k - 2);
    const Solution found = solved(scene_of(
        R"(["x", "y"])", fmt::format("(x'^2 + y'^2)/2 + ((1 - x^2 - {0}*y^2)^2 + (2*{0}*x*y)^2)/2", k),
        "start = { x = -1, y = 0 }\nend = { x = 1, y = 0 }\n",
        fmt::format(
            "[guess]\nx = \"tanh({0}*(t - T/2))\"\ny = \"{1:.17g}/cosh({0}*(t - T/2))\"\nduration = 50\n",
            rate, height)));
    ASSERT_TRUE(found.converged()) << found.message;
    EXPECT_NEAR(found.action, 4.0 / 3, 1e-10);
    EXPECT_EQ(found.morse_index, 0);
    EXPECT_EQ(found.nullity, 2) << "the shift in time, and the height";
    EXPECT_TRUE(found.minimizing);
    EXPECT_TRUE(found.conjugate_times.empty());
    EXPECT_NE(found.message.find("one of a family"), std::string::npos) << found.message;
    std::vector<double> q(2), v(2);
    double highest = 0;
    for (int j = 0; j <= 1000; ++j) {
      found.trajectory.at(found.duration() * j / 1000, q, v);
      highest = std::max(highest, q[1]);
    }
    EXPECT_NEAR(highest, height, 1e-4 * height);
  }
}

/// A bubble with a thin wall: its radius, 17.47 by shooting, is far from that of the guess.
TEST_F(InfiniteEndsOf, BouncesWithAThinWall) {
  for (const double radius : {6.0, 12.0, 19.0, 24.0}) {
    const Solution found =
        solved(scene_of("[\"f\"]", "t^2*(f'^2/2 + f^2/2 - f^3/2 + 0.12*f^4)", "end = { f = 0 }\n",
                        fmt::format("[guess]\nduration = 29.5\nf = \"2.16/(1 + exp(t - {}))\"\n", radius)));
    ASSERT_TRUE(found.converged()) << radius << ": " << found.message;
    EXPECT_NEAR(found.action, 83.5912181414, 1e-7) << radius;
    EXPECT_EQ(found.morse_index, 1) << radius;
  }
}

/// The part of the time axis that a guess describes lasts until the guess comes to its equilibrium. S by
/// shooting.
TEST_F(InfiniteEndsOf, AGuessThatArrivesLate) {
  const Solution found = solved(scene_of("[\"f\"]", "t^3*(f'^2/2 + (f^2 - 1)^2/2 + 0.3*(f - f^3/3) - 0.2)",
                                         "end = { f = 1 }\n", "[guess]\nf = \"tanh(t - 10)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NEAR(found.action, 326.86625, 1e-4);
}
