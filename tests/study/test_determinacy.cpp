#include <cmath>

#include "scenes.hpp"
#include "solution/extension_values.hpp"

using namespace extremal;
using namespace extremal::test;

/// \file Conditions that determine nothing, and unknowns that nothing determines, by the formulas alone. The
/// relations are linear algebra done by hand.

namespace {

const std::string law = "[system]\ncoordinates = [\"x\"]\nparameters = { a = 0.3, b = 0.2 }\nlagrangian = \"";

/// The place and the first words of a refusal.
void expect_start(const std::string& message, const std::string& start) {
  EXPECT_EQ(message.substr(0, start.size()), start) << message;
}

}  // namespace

/// Integrals whose variations depend on each other along all paths: multiples, what no path changes, and
/// total derivatives, which the ends determine.
TEST_F(Scenes, IntegralsThatDetermineEachOther) {
  const auto refused = [&](const std::string& ends, const std::string& integrals) {
    return message("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2 - x^4/4\"\n[boundary]\n" +
                   ends + "\nduration = 1\nintegrals = [" + integrals + "]\n[guess]\nx = \"t\"\n");
  };
  const std::string fixed = "start = { x = 0 }\nend = { x = 1 }", at_start = "start = { x = 0 }\n";
  const std::string text = "the ends and the integrals before it determine the integral ";
  expect_start(refused(fixed, "\"1 = 1\""), "scene.toml:8:15: " + text + "'1 = 1'");
  expect_start(refused(fixed, "\"x = 0.5\", \"2*x + t = 1.5\""), "scene.toml:8:26: " + text);
  expect_start(refused(fixed, "\"x^2*x' = 2\""), "scene.toml:8:15: " + text);
  expect_start(refused(fixed, "\"x^2 = 1\", \"x^2 + sin(x)*x' = 2\""), "scene.toml:8:26: " + text);
  // A free end and a closed path: the first gives sin(x)x' a meaning, the second takes it.
  EXPECT_EQ(refused(at_start, "\"x^2 = 1\", \"x^2 + sin(x)*x' = 2\""), "");
  expect_start(refused("periodic = true", "\"x^2 = 1\", \"x^2 + sin(x)*x' = 2\""),
               "scene.toml:7:26: " + text);
}

/// A condition at ends that are given, and one that another implies.
TEST_F(Scenes, ConditionsThatSelectNoUnknown) {
  const auto refused = [&](const std::string& unknowns, const std::string& where) {
    return message(law + "x'^2/2 - (a + b^2)*x^2/2\"\n[boundary]\nstart = { x = 1 }\nduration = 2\n" +
                   "unknowns = {" + unknowns + "}\nwhere = [" + where + "]\n");
  };
  expect_start(refused("a = 0.3", "\"x(0) = 1\""), "scene.toml:9:11: the condition 'x(0) = 1' follows");
  expect_start(refused("a = 0.3", "\"x(0) = 2\""), "scene.toml:9:11: the condition 'x(0) = 2' follows");
  expect_start(refused("a = 0.3, b = 0.2", "\"x(T) = 0.7\", \"2*x(T) + x(0) = 2.4\""),
               "scene.toml:9:25: the condition '2*x(T) + x(0) = 2.4' follows");
  expect_start(refused("a = 0.3, b = 0.2", "\"x(T) = 0.7\", \"a*x(T) = 0.2\""), "");
  EXPECT_EQ(refused("a = 0.3", "\"x(T) = 0.7\""), "");
}

/// A condition that closes a duration, and that all paths between the ends meet, or none.
TEST_F(Scenes, ConditionsThatDetermineNoDuration) {
  const auto refused = [&](const std::string& form, const std::string& where) {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - (x^4 + y^2)/2\"\n"
        "[boundary]\n" +
        form + "\nduration = \"free\"\nwhere = \"" + where + "\"\n" +
        "[guess]\nx = \"cos(2*pi*t/T)\"\ny = \"sin(2*pi*t/T)\"\nduration = 6\n");
  };
  const std::string closed = "periodic = true", turned = "periodic = true\nmap = { x = \"-x\" }";
  expect_start(refused(closed, "x(0) = x(T)"),
               "scene.toml:7:10: the condition 'x(0) = x(T)' follows from what else is given at the ends, or "
               "contradicts it; give the duration, or 'energy' instead of 'where'");
  expect_start(refused(closed, "x(0)*y(T) - y(0)*x(T) = 1"), "scene.toml:7:10: the condition ");
  expect_start(refused(turned, "x(0) + x(T) = 0"), "scene.toml:8:10: the condition ");
  EXPECT_EQ(refused(turned, "x(0) - x(T) = 1"), "");
  EXPECT_EQ(refused(closed, "x(0) = 0.5"), "");
  EXPECT_EQ(refused("conditions = [\"y(0) = 0\"]", "x(T) = 0.5"), "");
}

/// One combination of constants: a + b², and a constant with the multiplier of an integral. Of L = … + a cos
/// t no equation contains a.
TEST_F(Scenes, UnknownsThatNothingDetermines) {
  const std::string ends = "[boundary]\nstart = { x = 1 }\nduration = 2\n";
  expect_start(message(law + "x'^2/2 - x^2/2 + a*cos(t) + b\"\n" + ends +
                       "unknowns = { a = 0.3 }\nwhere = [\"x(T) = 2\"]\n"),
               "scene.toml:8:14: no equation of the path and no condition contains 'a'");
  expect_start(message(law + "x'^2/2 - (a + b^2)*x^2/2\"\n[boundary]\nduration = 2\n" +
                       "unknowns = { a = 0.3, b = 0.2 }\nwhere = [\"x(0) = 1\", \"x(T) = 0.7\"]\n"),
               "scene.toml:7:23: all equations and conditions contain 'b' and 'a' in one combination alone");
  expect_start(message(law + "x'^2/2 - (a + b)*x^2/2 - x^4\"\n" + ends +
                       "integrals = [\"x^2 = 1.5\"]\nunknowns = { a = 0.3 }\nwhere = [\"x(T) = 0.7\"]\n"),
               "scene.toml:9:14: all equations and conditions contain 'a' and the multiplier of 'x^2 = 1.5' "
               "in one combination alone");
  EXPECT_EQ(message(law + "x'^2/2 - (a + b)*x^2/2 - x^4\"\n" + ends +
                    "integrals = [\"x^2 = 1.5\"]\nunknowns = { a = 0.3 }\nwhere = [\"a = 0.7\"]\n"),
            "");
}

/// Beside constraints: x² + y² = l² holds at the end without being asked for.
TEST_F(Scenes, ConditionsThatConstraintsImply) {
  const auto refused = [&](const std::string& where) {
    return message(
        "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { l = 1.0, g = 1.0 }\n"
        "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n[boundary]\n"
        "start = { x = 0, y = -1 }\nduration = 1\nunknowns = { g = 1.0 }\nwhere = [\"" +
        where + "\"]\n[guess]\nx = \"sin(t)\"\ny = \"-cos(t)\"\n");
  };
  expect_start(refused("x(T)^2 + y(T)^2 = 1"),
               "scene.toml:10:11: the condition 'x(T)^2 + y(T)^2 = 1' follows");
  EXPECT_EQ(refused("x(T) = 0.5"), "");
}

/// The centre of a circle that the path meets at right angles in (2, 0.6), where its momentum is (2, 0.1):
/// the condition and its normal contain a and b each in its own way.
TEST_F(Scenes, UnknownsThatOneConditionTellsApart) {
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { a = 3, b = 0.2 }\n"
                "lagrangian = \"(x'^2 + y'^2)/2 - y\"\n[boundary]\nduration = 1\n"
                "conditions = [\"x(0) = 0\", \"y(0) = 0\", \"(x(T) - a)^2 + (y(T) - b)^2 = 1\"]\nunknowns = "
                "{ a = 3, b = 0.2 }\n"
                "where = [\"y(T) = 0.6\", \"x(T) = 2\"]\n[guess]\nx = \"2*t\"\ny = \"0.5*t\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double size = std::hypot(2, 0.1);
  EXPECT_NEAR(solution.extension->unknowns[0].second, 2 + 2 / size, 1e-12);
  EXPECT_NEAR(solution.extension->unknowns[1].second, 0.6 + 0.1 / size, 1e-12);
}

/// ∫x = 2c over x = 0.3 (2t − t²/2): 0.8.
TEST_F(Scenes, IntegralsGivenByUnknowns) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 0 }\n"
      "integrals = [\"x = 2*c\"]\nunknowns = { c = 0.3 }\nwhere = [\"x(T) = 0.6\"";
  const Solution solution = run(study(scene + "]\nduration = 2\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.extension->unknowns[0].second, 0.4, 1e-12);
  EXPECT_NEAR(solution.action, 0.09 * 8 / 6, 1e-12);
  expect_start(message(scene + ", \"c = 0.4\"]\nduration = \"free\"\n[guess]\nduration = 2\n"),
               "scene.toml:6:18: the right side depends on an unknown, which needs a duration");
}

/// No ray from the origin arrives at right angles at a circle about it, but in no time.
TEST_F(Scenes, DurationsThatShrinkToNothing) {
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - y\"\n[boundary]\n"
                "conditions = [\"x(0) = 0\", \"y(0) = 0\", \"x(T)^2 + y(T)^2 = 4\"]\nduration = \"free\"\n"
                "where = \"y(T) = -0.7\"\n[guess]\nx = \"t\"\ny = \"-t/2\"\nduration = 1\n"));
  EXPECT_FALSE(solution.converged());
}

/// x = 1 is a double root: the condition holds there to roundoff for 1 ± 10⁻⁸ too.
TEST_F(Scenes, ConditionsWithADoubleRoot) {
  const auto told = [&](const std::string& boundary) {
    const Solution solution = run(
        study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - k*x^2/2\"\nparameters = { k = 1.0 }\n"
              "[boundary]\nduration = 1\n" +
              boundary));
    return solution.converged() ? std::string() : solution.message;
  };
  expect_start(told("conditions = [\"x(0) = 0\", \"x(T)^2 - 2*x(T) + 1 = 0\"]\n"),
               "the derivative of condition 1 vanishes where it holds");
  expect_start(told("start = { x = 1 }\nunknowns = { k = 1.0 }\nwhere = [\"x(T)^2 - x(T) + 0.25 = 0\"]\n"),
               "the derivative of 'where' condition 1 vanishes where it holds");
  EXPECT_EQ(told("conditions = [\"x(0) = 0\", \"x(T) = 1\"]\n"), "");
  EXPECT_EQ(told("conditions = [\"x(0) = 0\", \"x(T)^2 - 2*x(T) + 0.999 = 0\"]\n"), "");
}

/// Where L + ν g is not convex in x', discrete equations have solutions with corners at nodes. Momentum and
/// energy are constant along an extremal of these, and so is x': its length is √2.
TEST_F(Scenes, IntegralsThatOnlyBrokenPathsHave) {
  const auto refused = [&](const std::string& length, const std::string& more = "") {
    const Solution solution =
        run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 0 }\n"
                  "end = { x = 1 }\nduration = 1\nintegrals = [\"sqrt(1 + x'^2) = " +
                  length + "\"]\n" + more));
    EXPECT_FALSE(solution.converged()) << length;
    EXPECT_TRUE(solution.trajectory.times.empty());
    return solution.message;
  };
  for (const char* length : {"1.42", "1.6", "3"}) expect_start(refused(length), "the velocity jumps by ");
  expect_start(refused("1.6", "[solve]\nscheme = \"midpoint\"\nelements = 12\n"), "the velocity jumps by ");
}

/// The same of L itself, whatever finds the path: p = q'³ − q' has one value at three velocities.
TEST_F(Scenes, BrokenPathsOfAllKindsAreRefused) {
  const auto refused = [&](const std::string& more, const std::string& boundary, const std::string& guess) {
    const Solution solution =
        run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"(x'^2 - 1)^2/4 + x*sin(2*t)/5\"\n" + more +
                  "[boundary]\n" + boundary + guess));
    EXPECT_FALSE(solution.converged());
    expect_start(solution.message, "the velocity jumps by ");
  };
  const std::string zigzag = "[guess]\nx = \"max(0, t - 1)\"\n",
                    ends = "start = { x = 0 }\nend = { x = 1 }\nduration = 2\n";
  refused("", ends, zigzag);
  refused("", ends, zigzag + "[solve]\nscheme = \"lobatto(3)\"\nelements = 8\n");
  refused("force = { x = \"-0.1*x'\" }\n", ends, "[guess]\nx = \"min(1.2*t, 1.4 - 0.2*t)\"\n");
}

/// Motions end where p reaches its extremum; with so large elements Newton's method finds another branch.
TEST_F(Scenes, AMarchDoesNotLeapToAnotherBranchOfMomenta) {
  const Solution solution = run(
      study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"(x'^2 - 1)^2/4 + x*0.3\"\n[boundary]\n"
            "start = { x = 0.1, p_x = 0.1 }\nduration = 3\n[solve]\nscheme = \"midpoint\"\nelements = 16\n"));
  EXPECT_FALSE(solution.converged());
  expect_start(solution.message, "the velocity jumps by ");
}
