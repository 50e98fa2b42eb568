#include <fmt/format.h>

#include <cmath>

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

TEST_F(Scenes, GuessFormulas) {
  const Study s = study(masses + ends + "[guess]\nx = \"k*sin(pi*t/T)\"\nq = \"i*t\"\n");
  for (const double tau : {0.0, 0.1234, 0.5, 0.99, 1.0}) {
    EXPECT_NEAR(guessed(s, tau, 0), 4 * std::sin(M_PI * tau), 1e-9);
    for (int i = 1; i <= 3; ++i) EXPECT_NEAR(guessed(s, tau, i), i * 2 * tau, 1e-14);
  }
}

TEST_F(Scenes, GuessListsElementsAndWhatIsLeftOut) {
  const Study s = study(masses +
                        "[boundary]\nstart = { q = [1, 1, 1] }\nend = { x = 3, \"q[3]\" = 5 }\nduration = 2\n"
                        "[guess]\n\"q[1]\" = \"t^2\"\n");
  EXPECT_NEAR(guessed(s, 0.5, 1), 1.0, 1e-14);
  EXPECT_EQ(guessed(s, 0.5, 0), 3.0);  // one end fixed
  EXPECT_EQ(guessed(s, 0.5, 2), 1.0);
  EXPECT_EQ(guessed(s, 0.5, 3), 3.0);  // the line
  const Study list = study(masses + ends + "[guess]\nq = [\"t\", 2, \"T\"]\n");
  EXPECT_NEAR(guessed(list, 0.25, 1), 0.5, 1e-15);
  EXPECT_EQ(guessed(list, 0.25, 2), 2.0);
  EXPECT_EQ(guessed(list, 0.25, 3), 2.0);
}

TEST_F(Scenes, GuessFormulasThatAreWrong) {
  const auto guess = [&](const std::string& s) { return message(masses + ends + "[guess]\n" + s + "\n"); };
  EXPECT_EQ(guess("fiel = \"a.csv\""),
            "scene.toml:11:1: unknown coordinate 'fiel'; the system has x, q; did you mean 'file'?");
  EXPECT_EQ(guess("q = [\"t\", \"t\"]"), "scene.toml:11:5: 'q' has 3 elements; found 2 values");
  EXPECT_EQ(guess("x = \"log(t - 1)\""), "scene.toml:11:6: the guess is not finite at t = 0");
  EXPECT_EQ(guess("x = \"2*tt\"").rfind("scene.toml:11:8: ", 0), 0u);
  EXPECT_EQ(guess("x = \"2*(t\"").rfind("scene.toml:11:", 0), 0u);
}

/// Guesses are shifted linearly in t onto the ends: here to 0.1 + 0.9 t.
TEST_F(Scenes, GuessIsFiniteWhereItIsShiftedTo) {
  const auto from = [&](const std::string& guess) {
    return message(
        "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - log(x)\"\n[boundary]\n"
        "start = { x = 0.1 }\nend = { x = 1 }\nduration = 1\n[guess]\nx = \"" +
        guess + "\"\n");
  };
  EXPECT_EQ(from("t - 0.5"), "");
  EXPECT_EQ(from("0.6 - 2*sin(pi*t)").rfind("scene.toml:8:1: L is not finite on the guess at t = ", 0), 0u);
}

TEST_F(Scenes, GuessWhereTheLagrangianIsNotFinite) {
  const std::string kepler =
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + 1/sqrt(x^2 + "
      "y^2)\"\n[boundary]\n"
      "start = { x = 1, y = 0 }\nend = { x = -1, y = 0 }\nduration = 2\n";
  EXPECT_EQ(message(kepler + "[guess]\nx = \"1 - t\"\ny = 0\n"),
            "scene.toml:8:1: L is not finite on the guess at t = 1: x = 0, y = 0");
  EXPECT_EQ(message(kepler + "[guess]\nx = \"1 - t\"\ny = \"t*(2 - t)\"\n"), "");
  // At t = 0 the fixed start stands in.
  EXPECT_EQ(message(kepler + "[guess]\nx = \"t\"\ny = \"t*(3 - t)\"\n"), "");
  EXPECT_EQ(message(kepler), "");  // the default guess is the program's
}

TEST_F(Scenes, GuessFromCsv) {
  write("g.csv", "# observed\n t , \"q[1]\",x,q[2],q[3]\n1,10,0,1,2\n2,11,1,1,2\r\n\n5,14,4,1,2\n");
  const Study s = study(masses + ends + "[guess]\nfile = \"g.csv\"\n");
  ASSERT_EQ(s.problem.guess.tau, (std::vector<double>{0, 0.25, 1}));
  EXPECT_NEAR(guessed(s, 0.5, 0), 2.0, 1e-14);
  EXPECT_NEAR(guessed(s, 0.5, 1), 12.0, 1e-13);
  EXPECT_EQ(s.problem.duration.value, 2.0);
}

TEST_F(Scenes, GuessFileGivesAFreeDuration) {
  write("g.csv", "t,x,q[1],q[2],q[3]\n0,0,1,1,2\n2.5,1,1,1,2\n");
  const std::string scene =
      masses + "[boundary]\nduration = \"free\"\nenergy = 1\n[guess]\nfile = \"g.csv\"\n";
  EXPECT_EQ(study(scene).problem.duration.value, 2.5);
  EXPECT_EQ(study(scene, {"guess.duration=3"}).problem.duration.value, 3.0);
}

TEST_F(Scenes, GuessFromAResult) {
  write("r.json", R"({"status": "converged", "samples": {"t": [0, 1, 2], "x": [0, 1, 4], "x'": [0, 0, 0],
                      "q[1]": [1, 2, 3], "q[2]": [0, 0, 0], "q[3]": [1, 1, 1]}})");
  const Study s = study(masses + ends + "[guess]\nfile = \"r.json\"\n");
  EXPECT_NEAR(guessed(s, 0.75, 0), 2.25, 1e-14);  // a parabola through three samples
  write("r.json", "{\"status\": \"converged\"}");
  EXPECT_EQ(message(masses + ends + "[guess]\nfile = \"r.json\"\n"),
            "r.json: the file has no samples; write it with --samples 201 to have some");
  write("r.json", "{\"samples\": {\"t\": [0, 1], \"x\": [0, null]}}");
  EXPECT_EQ(message(masses + ends + "[guess]\nfile = \"r.json\"\n"),
            "r.json: 'x' of the samples is not a list of finite numbers");
  write("r.json", "{\"samples\": {\"t\": [0, 1], \"x\": [0]}}");
  EXPECT_EQ(message(masses + ends + "[guess]\nfile = \"r.json\"\n"),
            "r.json: the samples have 2 times and 1 values of 'x'");
  write("r.json", std::string(1'000'000, '['));
  EXPECT_EQ(message(masses + ends + "[guess]\nfile = \"r.json\"\n").rfind("r.json:", 0), 0u);
}

TEST_F(Scenes, GuessFilesThatAreWrong) {
  const auto csv = [&](const std::string& content) {
    write("g.csv", content);
    return message(masses + ends + "[guess]\nfile = \"g.csv\"\n");
  };
  EXPECT_EQ(csv("t,x,q[1],q[2]\n0,0,0,0\n1,1,1,1\n"),
            "g.csv:1:1: the file has no column 'q[3]'; it has t, x, q[1], q[2]");
  EXPECT_EQ(csv("t,x,q[1],q[2],q[3]\n0,0,0,0,0\n1,1,a,1,1\n"), "g.csv:3:5: 'a' is not a finite number");
  EXPECT_EQ(csv("t,x,q[1],q[2],q[3]\n0,0,0,0,0\n1,1,nan,1,1\n"), "g.csv:3:5: 'nan' is not a finite number");
  EXPECT_EQ(csv("t,x,q[1],q[2],q[3]\n0,0,0,0,0\n1,1,1,1\n"), "g.csv:3:1: found 4 values for 5 columns");
  EXPECT_EQ(csv("t,x,q[1],q[2],q[3]\n0,0,0,0,0\n"), "g.csv:2:1: found 1 sample; need at least 2");
  EXPECT_EQ(csv("x,t,q[1],q[2],q[3]\n# none\n"), "g.csv:1:1: found 0 samples; need at least 2");
  EXPECT_EQ(csv("# none\n"), "g.csv: the file has no columns; write a column t and one for each coordinate");
  EXPECT_EQ(csv("t,x,q[1],q[2],q[3]\n0,0,0,0,0\n0,0,0,0,0\n"),
            "g.csv:3:1: the times must increase; found 0 after 0; order the rows by t, one path a file");
  EXPECT_EQ(csv("x,t,q[1],q[2],q[3]\n0,0,0,0,0\n0,2,0,0,0\n\n0,1,0,0,0\n"),
            "g.csv:5:3: the times must increase; found 1 after 2; order the rows by t, one path a file");
  EXPECT_EQ(csv("time,x,q[1],q[2],q[3]\n0,0,0,0,0\n1,1,1,1,1\n"),  // without velocities: a path
            "g.csv:1:1: the file has no column 't'; it has time, x, q[1], q[2], q[3]");
  EXPECT_EQ(csv("time,x,x',q[1],q[2],q[3]\n0,0,0,0,0,0\n"),  // a state
            "g.csv:1:1: the file has no column 'q[1]''; it has time, x, x', q[1], q[2], q[3]");
  EXPECT_EQ(csv("t;x\n0;1\n"),
            "g.csv:1:1: the file has no column 't'; it has t;x alone: commas separate columns");
  EXPECT_EQ(message(masses + ends + "[guess]\nfile = \"none.csv\"\n"),
            "scene.toml:11:8: no such file: 'none.csv'");
}

TEST_F(Scenes, GuessFromAState) {
  const Study s =
      study(masses + ends + "[guess.state]\nx = 1\n\"x'\" = \"k/2\"\nq = [0, 1, 2]\n\"q[1]'\" = 3\n");
  const double w = std::sqrt(2.0);  // m[2] x'' = -k x
  for (const double t : {0.0, 0.3, 1.1, 2.0}) {
    EXPECT_NEAR(guessed(s, t / 2, 0), std::cos(w * t) + 2 / w * std::sin(w * t), 1e-6);
    EXPECT_NEAR(guessed(s, t / 2, 1), 3 * std::sin(t), 1e-6);
    EXPECT_NEAR(guessed(s, t / 2, 3), 2 * std::cos(t), 1e-6);
  }
  EXPECT_EQ(message(masses + ends + "[guess.state]\nq = [0, 1]\n"),
            "scene.toml:11:5: 'q' has 3 elements; found 2 values");
  EXPECT_EQ(message(masses + ends + "[guess]\nstate = { \"y'\" = 1 }\n"),
            "scene.toml:11:11: unknown coordinate 'y'; the system has x, q");
}

TEST_F(Scenes, GuessFromAStateThatEndsInACollision) {
  const std::string text = message(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + 1/abs(x)\"\n[boundary]\nstart = { x = 1 }\n"
      "duration = 3\n[guess]\nstate = { x = 1 }\n");
  // From rest at 1 in the field -1/x^2 the centre is reached after pi/(2 sqrt 2).
  EXPECT_EQ(
      text.rfind("scene.toml:7:1: the initial state of the guess cannot be integrated beyond t = 1.1107", 0),
      0u)
      << text;
}

TEST_F(Scenes, GuessFromAStateOfTooManyOscillations) {
  const std::string text = message(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - 1e10*x^2/2\"\n[boundary]\nstart = { x = 1 }\n"
      "duration = 1000\n[guess]\nstate = { x = 1 }\n");
  EXPECT_EQ(text.rfind("scene.toml:7:1: the motion from guess.state makes about 1.6e+07 oscillations", 0), 0u)
      << text;
}

/// Over the top of V = -|x - 0.7| at the velocity u = 0.006, to roundoff of x: the motion is known in closed
/// form.
TEST_F(Scenes, GuessFromAStateThatCrossesAKinkSlowly) {
  const double u = 0.006, v0 = std::sqrt(1 + u * u), crossing = v0 - u;
  const Study s = study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + abs(x - 0.7)\"\n[boundary]\n"
      "start = { x = 0.2 }\nduration = 2\n[guess]\nstate = { x = 0.2, \"x'\" = \"sqrt(1 + 0.006^2)\" }\n");
  for (const double t : {0.5, 0.9, 1.0, 1.3, 2.0}) {
    const double after = t - crossing;
    EXPECT_NEAR(guessed(s, t / 2, 0),
                after < 0 ? 0.2 + v0 * t - t * t / 2 : 0.7 + u * after + after * after / 2, 1e-8)
        << t;
  }
}

/// A Kepler arc through the pericentre from its exact state, by the eccentric anomaly from -2.5 to 2. The
/// loosest tolerance is many times the pericentre's distance; elements that only meet it do not resolve the
/// passage. Doubles lose the time of the passage against the forces there from e = 0.999999 on. Without a
/// whole turn there is no conjugate time.
TEST_F(Scenes, TheExtremalOfAnExactMotionIsFoundAtAnyTolerance) {
  LONG_TEST();
  const auto position = [](double e, double E) {
    return std::array{std::cos(E) - e, std::sqrt(1 - e * e) * std::sin(E)};
  };
  const auto velocity = [](double e, double E) {
    const double rate = 1 / (1 - e * std::cos(E));
    return std::array{-rate * std::sin(E), rate * std::sqrt(1 - e * e) * std::cos(E)};
  };
  const std::pair<double, double> cases[] = {
      {0.99999, 1e-3}, {0.99999, 1e-12}, {0.999999, 1e-3}, {0.999999, 1e-9}};
  for (const auto& [e, tolerance] : cases) {
    const std::array q = position(e, -2.5), v = velocity(e, -2.5), end = position(e, 2);
    const Study s = study(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)\"\n" +
            fmt::format(
                "[boundary]\nstart = {{ x = {}, y = {} }}\nend = {{ x = {}, y = {} }}\nduration = {}\n", q[0],
                q[1], end[0], end[1], 2 - e * std::sin(2) + 2.5 - e * std::sin(2.5)) +
            fmt::format("[guess]\nstate = {{ x = {}, y = {}, \"x'\" = {}, \"y'\" = {} }}\n", q[0], q[1], v[0],
                        v[1]),
        {fmt::format("solve.tolerance={}", tolerance)});
    const Solution solution = run(s);
    ASSERT_TRUE(solution.converged()) << e << ' ' << tolerance << ' ' << solution.message;
    EXPECT_EQ(solution.strategy, "newton from the guess");
    EXPECT_EQ(solution.morse_index, 0);
    EXPECT_NEAR(solution.momentum_start[0], v[0], 1e-9);
    EXPECT_NEAR(solution.momentum_start[1], v[1], 1e-9);
  }
}

/// Moth I, from the state and the period in six digits that Suvakov and Dmitrasinovic give (Phys. Rev. Lett.
/// 110, 114301, 2013), and from one digit less: encounters amplify what is left out.
TEST_F(Scenes, OrbitsFromStatesOfFiveDigits) {
  for (const auto& [vx, vy] : {std::pair(0.464445, 0.396060), std::pair(0.46444, 0.39606)}) {
    const Solution orbit = run(
        study("[system]\nuse = \"nbody\"\n[boundary]\nperiodic = true\nduration = 14.8939\n[guess.state]\n"
              "x = [-1, 1, 0]\ny = [0, 0, 0]\n" +
              fmt::format("\"x'\" = [{0}, {0}, {1}]\n\"y'\" = [{2}, {2}, {3}]\n", vx, -2 * vx, vy, -2 * vy)));
    ASSERT_TRUE(orbit.converged()) << vx << ' ' << orbit.message;
    // Of three unit masses, with the kinetic energy 3 |v|^2 and the potential energy -5/2.
    EXPECT_NEAR(orbit.energy.value(), 3 * (vx * vx + vy * vy) - 2.5, 1e-3) << vx;
  }
}

/// Motions across kinks whose ends miss those wanted, by more and more: Newton's method leads to the extremal
/// beside each. It starts at rest from x = 1 and falls to and fro, x = 1 − t²/2 at first.
TEST_F(Scenes, GuessFromAStateAcrossKinks) {
  const double period = 4 * std::sqrt(2), left = 5 - period;
  for (const char* speed : {"1e-4", "0.01", "0.03", "0.1"}) {
    const Solution s = run(study(fmt::format(
        "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - abs(x)\"\n[boundary]\nstart = {{ x = 1 }}\n"
        "end = {{ x = {:.17g} }}\nduration = 5\n[guess.state]\nx = 1\n\"x'\" = {}\n",
        1 - left * left / 2, speed)));
    ASSERT_TRUE(s.converged()) << speed << ": " << s.message;
    EXPECT_NEAR(s.momentum_start[0], 0, 1e-12) << speed;
    EXPECT_EQ(s.strategy, "newton from the guess") << speed;
  }
}

TEST_F(Scenes, GuessFromAStateNeedsARegularMass) {
  EXPECT_EQ(message("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x' + y')^2/2\"\n[boundary]\n"
                    "duration = 1\n[guess]\nstate = { x = 1 }\n")
                .rfind("scene.toml:3:14: the Lagrangian is not regular", 0),
            0u);
}

TEST_F(Scenes, GuessFilesOfListsAreNoCsv) {
  for (const auto& [text, said] : {std::pair("[[[[", "from here on this is not JSON"),
                                   std::pair("[1, 2]", "guess.json: the file has no samples")}) {
    write("guess.json", text);
    const std::string what = message(masses + ends + "[guess]\nfile = \"guess.json\"\n");
    EXPECT_EQ(what.find("column"), std::string::npos) << what;
    EXPECT_EQ(what.rfind("guess.json:", 0), 0u) << what;
    EXPECT_NE(what.find(said), std::string::npos) << what;
  }
}

/// An arc of a Kepler ellipse through its pericentre, at 9e-4 to 4e-5 of the distance of its start: the
/// motion itself is the guess. Steps that are small against the whole path move it in time by more than
/// velocities there allow; so they go on until gradients and factors of more digits know no better.
TEST_F(Scenes, GuessOfAMotionThroughANearCollision) {
  for (const double speed : {0.03, 0.01, 0.006}) {  // at r = 2, across
    const double a = 1 / (1 - speed * speed), e = 2 / a - 1, T = 3.5;
    const double mean = M_PI + T / std::pow(a, 1.5);
    double anomaly = mean;
    for (int k = 0; k < 200; ++k)
      anomaly -= (anomaly - e * std::sin(anomaly) - mean) / (1 - e * std::cos(anomaly));
    const double x = a * (std::cos(anomaly) - e), y = -a * std::sqrt(1 - e * e) * std::sin(anomaly);
    const Study s =
        study(fmt::format("[system]\nuse = \"kepler\"\n[boundary]\n"
                          "start = {{ x = -2.0, y = 0.0 }}\nend = {{ x = {:.17g}, y = {:.17g} }}\n"
                          "duration = {}\n[guess]\n"
                          "state = {{ x = -2.0, y = 0.0, \"x'\" = 0.0, \"y'\" = {} }}\n",
                          x, y, T, speed));
    const Solution solution = Solver().solve(s.problem, s.options);
    ASSERT_TRUE(solution.converged()) << speed << solution.message;
    EXPECT_EQ(solution.strategy, "newton from the guess") << speed;
    EXPECT_NEAR(solution.momentum_start[1], speed, 1e-8) << speed;
    EXPECT_LT(*solution.energy_drift, 1e-8 / (speed * speed)) << speed;
  }
}
