#include <gtest/gtest.h>

#include "scenes.hpp"
#include "study/spectra.hpp"

using namespace extremal;
using namespace extremal::test;

/// \file Mends that are told lead to a scene that is accepted.

namespace {

const std::string law = "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\n";

}  // namespace

/// A duration after initial data is a number, whatever the guess and what closes it.
TEST_F(Scenes, FreeDurationAfterInitialData) {
  const std::string
      start = law + "[boundary]\nstart = { x = 0, p_x = 1 }\nduration = ",
      told =
          "scene.toml:6:12: 'start' gives initial data, every coordinate and every momentum: the "
          "duration must be a number, for nothing at the end closes it";
  EXPECT_EQ(message(start + "\"free\"\n"), told);
  EXPECT_EQ(message(start + "\"free\"\nenergy = 0.5\n"), told);
  EXPECT_EQ(message(start + "\"free\"\nenergy = 0.5\n[guess]\nduration = 2\n"), told);
  EXPECT_EQ(message(start + "2\n"), "");
}

TEST_F(Scenes, FreeDurationBetweenEnds) {
  const std::string between = law + "[boundary]\nstart = { x = 0 }\nend = { x = 0.5 }\nduration = \"free\"\n";
  EXPECT_EQ(message(between), "scene.toml:7:12: a free duration needs 'energy' or 'where' to close it");
  EXPECT_EQ(message(between + "energy = 0.5\n"),
            "scene.toml:7:12: a free duration needs 'duration' in [guess], or a guess file");
  EXPECT_EQ(message(between + "energy = 0.5\n[guess]\nduration = 0.5\n"), "");
}

/// Names that belong elsewhere.
TEST_F(Scenes, MomentaAndVelocitiesInOtherPlaces) {
  const std::string between = law + "[boundary]\nstart = { x = 0 }\nend = { x = 0.5 }\nduration = 2\n";
  const auto after = [&](const std::string& lines) { return message(between + lines); };
  const std::string momentum =
      "'p_x' is a momentum, and a coordinate stands here; momenta are given in 'start' and 'end' of "
      "[boundary], and a state in [guess] has velocities, \"x'\"";
  EXPECT_EQ(after("[[waypoints]]\nat = 1\np_x = 1\n"), "scene.toml:10:1: " + momentum);
  EXPECT_EQ(after("[[waypoints]]\nat = 1\n\"x'\" = 1\n"),
            "scene.toml:10:1: \"x'\" is a velocity, and a coordinate stands here");
  EXPECT_EQ(after("[guess]\nstate = { \"x''\" = 1 }\n"),
            "scene.toml:9:11: a second \"'\"; a state has coordinates and velocities");
  EXPECT_EQ(after("[guess]\nstate = { x = 0, p_x = 1 }\n"), "scene.toml:9:18: " + momentum);
  EXPECT_EQ(
      after("[guess]\n\"x'\" = \"t\"\n"),
      "scene.toml:9:1: \"x'\" is a velocity, which follows from x: give x as a formula of t, or a motion by "
      "its initial state: state = { x = …, \"x'\" = … }");
  EXPECT_EQ(after("[guess]\nstate = { x = 0, \"x'\" = 1 }\n"), "");
  EXPECT_EQ(message(law + "[boundary]\nstart = { x = 0 }\nend = { x = \"free\" }\nduration = 2\n"),
            "scene.toml:6:14: unknown name 'free'; a coordinate that is free is left out");
  EXPECT_EQ(message(law + "[boundary]\nstart = { x = 0 }\nend = {}\nduration = 2\n"), "");
}

/// Values at nodes are samples at equal times only where steps are equal.
TEST_F(Scenes, SamplesOfSpectra) {
  const auto with = [](const std::string& elements) {
    return law +
           "[boundary]\nstart = { x = 0 }\nend = { x = 0.5 }\nduration = 20\n[solve]\nscheme = "
           "\"midpoint\"\nelements = " +
           elements + "\n[spectrum]\nlines = 2\n";
  };
  EXPECT_EQ(message(with("6")),
            "scene.toml:10:12: elements = 6; a spectrum of values at nodes needs 15 elements; write that or "
            "more, or "
            "leave 'scheme' and 'elements' out");
  EXPECT_EQ(message(with("15")), "");
  EXPECT_EQ(message(with("6\nsteps = \"free\"")), "");
}

/// |x'| has no second derivative by x'.
TEST_F(Scenes, LengthOfALine) {
  for (const char* length : {"sqrt(x'^2)", "2*sqrt(x'^2/(1 + x^2))"}) {
    const std::string found =
        message(std::string("[system]\ncoordinates = [\"x\"]\nlagrangian = \"") + length +
                "\"\n[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 1\n");
    EXPECT_EQ(found.substr(0, 78),
              "scene.toml:3:14: the Lagrangian is homogeneous of degree one in the velocities")
        << found;
  }
  EXPECT_EQ(
      message("[system]\ncoordinates = [\"x\"]\nlagrangian = \"sqrt(1 + x'^2)\"\n[boundary]\nstart = { x "
              "= 0 }\nend = { x = 1 }\nduration = 1\n"),
      "");
}

TEST_F(Scenes, PlaceWhereJsonEnds) {
  write("guess.csv", "[[\n [1, é");
  EXPECT_EQ(message(law + "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 1\n[guess]\nfile = "
                          "\"guess.csv\"\n"),
            "guess.csv:2:6: from here on this is not JSON; write the file with solve --output, or as CSV "
            "with a line "
            "of names");
}

/// The action would jump with the time of the crossing.
TEST_F(Scenes, LagrangiansThatJump) {
  const auto scene = [](const std::string& law) {
    return "[system]\ncoordinates = [\"x\"]\n" + law +
           "\n[boundary]\nstart = { x = -1 }\nend = { x = 1 }\nduration = 1\n";
  };
  struct Case {
    std::string law, jump;
  };
  const Case jumps[] = {
      {"lagrangian = \"x'^2/2 - 0.3*x/abs(x)\"", "L jumps by 0.6 "},
      {"lagrangian = \"x'^2/2 - 0.5*max(x - 0.2, 0)/(x - 0.2)\"", "L jumps by 0.5 "},
      {"lagrangian = \"x'^2/2 + 0.1*abs(x')/x' - min(x, 0)\"", "L jumps by 0.2 "},
      {"hamiltonian = \"p_x^2/2 + 0.3*x/abs(x)\"", "H jumps by 0.6 "},
  };
  for (const Case& c : jumps)
    EXPECT_NE(message(scene(c.law)).find(": " + c.jump), std::string::npos) << message(scene(c.law));
  // The mend works: the energy of the smooth step is the same on both sides.
  const Solution smooth = run(study(scene("lagrangian = \"x'^2/2 - 0.3*tanh(x/0.1)\"")));
  ASSERT_TRUE(smooth.converged()) << smooth.message;
  EXPECT_LT(*smooth.energy_drift, 1e-8);
  // Continuous ones, of which powers, quotients and what lies beside a kink are infinitely steep.
  for (const char* potential :
       {"abs(x)", "x*abs(x)", "sqrt(abs(x))", "abs(x)^1.5", "max(0, x)^2/(1 + abs(x))", "min(abs(x), 0.3)",
        "x^2/(1e-3 + abs(x))", "max(x, 0.5*x)"})
    EXPECT_EQ(message(scene(fmt::format("lagrangian = \"x'^2/2 - {}\"", potential))), "") << potential;
}
