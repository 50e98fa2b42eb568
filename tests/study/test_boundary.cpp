#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "rivals/shooting.hpp"
#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// The value that the relation fixes an end coordinate to; NaN where it leaves it free.
double fixed(const Study& study, int e) {
  return study.problem.ends.fixed[e] ? study.problem.ends.offset[e]
                                     : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

TEST_F(Scenes, EndsAreNumbersFormulasListsAndElements) {
  const Study s =
      study(masses +
            "[boundary]\nstart = { x = \"sqrt(k) + m[2]\", q = [1, \"k/8\", 3] }\nend = { \"q[2]\" = -2.5 }\n"
            "duration = \"pi/2\"\n");
  EXPECT_EQ(s.problem.names, (std::vector<std::string>{"x", "q[1]", "q[2]", "q[3]"}));
  EXPECT_EQ(fixed(s, 0), 4.0);
  EXPECT_EQ(fixed(s, 1), 1.0);
  EXPECT_EQ(fixed(s, 2), 0.5);
  EXPECT_EQ(fixed(s, 3), 3.0);
  EXPECT_TRUE(std::isnan(fixed(s, 4)));
  EXPECT_EQ(fixed(s, 6), -2.5);
  EXPECT_EQ(s.problem.ends.free, 3);
  EXPECT_DOUBLE_EQ(s.problem.duration.value, 1.5707963267948966);
  EXPECT_FALSE(s.problem.guess.given());
}

/// Elements with more unknowns than a dense matrix takes. By modes of a chain with a natural end the index is
/// Σ ⌊Tω_k/π + 1/2⌋, and the momentum at the start ω tan(ωT) times the coordinates, where these are one mode.
TEST_F(Scenes, NaturalEndsOfManyCoordinates) {
  const int n = 200;
  const double T = 2.1;
  const Study s = study(
      "[system]\ncoordinates = [\"x[n]\"]\nparameters = { n = 200, a = 0.5, k = 0.3 }\n"
      "lagrangian = \"sum(i,1,n,x[i]'^2/2 - a*x[i]^2/2) - k/2*x[1]^2 - k/2*x[n]^2 - "
      "sum(i,1,n-1,k*(x[i+1]-x[i])^2/2)\"\n[boundary]\nstart = { x = \"0.1*sin(3*pi*i/(n+1))\" }\n"
      "duration = 2.1\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  const auto rate = [&](int k) {
    const double half = std::sin(k * std::numbers::pi / (2 * (n + 1)));
    return std::sqrt(0.5 + 4 * 0.3 * half * half);
  };
  int index = 0;
  for (int k = 1; k <= n; ++k) index += static_cast<int>(std::floor(T * rate(k) / std::numbers::pi + 0.5));
  EXPECT_EQ(solution.morse_index, index);
  for (const int i : {1, 50, 200})
    EXPECT_NEAR(solution.momentum_start[i - 1],
                0.1 * rate(3) * std::tan(rate(3) * T) * std::sin(3 * std::numbers::pi * i / (n + 1)), 1e-9);
}

TEST_F(Scenes, EndsThatAreWrong) {
  const auto start = [&](const std::string& s) {
    return message(masses + "[boundary]\nstart = { " + s + " }\nduration = 2\n");
  };
  EXPECT_EQ(start("xx = 0"),
            "scene.toml:7:11: unknown coordinate 'xx'; the system has x, q; did you mean 'x'?");
  EXPECT_EQ(start("\"q[4]\" = 0"), "scene.toml:7:11: 'q[4]' is out of range: 'q' has elements 1 to 3");
  EXPECT_EQ(start("\"q[0]\" = 0"), "scene.toml:7:11: 'q[0]' is out of range: 'q' has elements 1 to 3");
  EXPECT_EQ(start("\"x[1]\" = 0"), "scene.toml:7:11: 'x' is not an array; write 'x' in place of 'x[1]'");
  EXPECT_EQ(start("q = [1, 2]"), "scene.toml:7:15: 'q' has 3 elements; found 2 values");
  EXPECT_EQ(
      start("q = 1"),
      "scene.toml:7:15: 'q' has 3 elements; give a list of 3 values, a formula in the index i (\"1\" for all "
      "alike), or \"q[1]\" = … for one element");
  EXPECT_EQ(start("x = [1, 2]"), "scene.toml:7:15: 'x' is one number; found a list of 2");
  EXPECT_EQ(start("x = \"1/0\""), "scene.toml:7:16: the value is not finite");
  EXPECT_EQ(start("q = [0, 0, 0], \"q[2]\" = 1"),
            "scene.toml:7:35: 'q[2]' is given by its whole array already; leave one of them out");
  EXPECT_EQ(
      start("x = 0, p_x = 1"),
      "scene.toml:7:24: 'x' and 'p_x' are both given at this end; leave one of them out, it follows; for "
      "initial data the start needs both of every coordinate, and 'q[1]' is missing");
  EXPECT_EQ(start("x = 0, q = \"0*i\", p_x = 1, p_q = [1, 2, 3]"), "");
  EXPECT_EQ(
      start("\"x'\" = 1"),
      "scene.toml:7:11: \"x'\" is a velocity, and 'start' holds coordinates and momenta (p_x = ∂L/∂x'); "
      "give p_x here or, for a motion as guess, state = { \"x'\" = … } in [guess]");
  EXPECT_EQ(start("p_y = 1").substr(0, 37), "scene.toml:7:11: unknown coordinate '");
  EXPECT_EQ(start("v_x = 1"),
            "scene.toml:7:11: unknown coordinate 'v_x'; velocities are written \"x'\", and only "
            "'state' in [guess] holds them");
}

TEST_F(Scenes, InitialData) {
  const std::string data = "start = { x = \"k/2\", q = \"i\", p_x = -1, p_q = [\"k\", 0, 5] }\n";
  const Study s = study(masses + "[boundary]\n" + data + "duration = 2\n");
  ASSERT_TRUE(s.problem.initial);
  EXPECT_EQ(s.problem.initial->q, (std::vector<double>{2, 1, 2, 3}));
  EXPECT_EQ(s.problem.initial->p, (std::vector<double>{-1, 4, 0, 5}));
  EXPECT_EQ(natural_conditions(s.problem), 0);
  const Solution motion = run(s);
  ASSERT_TRUE(motion.converged()) << motion.message;
  EXPECT_NEAR(motion.momentum_end[2], -2 * std::sin(2.0), 1e-8);
}

TEST_F(Scenes, InitialDataThatAreMoreOrLess) {
  const auto refused = [&](const std::string& boundary, const std::string& rest = "",
                           const std::vector<std::string>& sets = {}) {
    return message("[system]\nuse = \"kepler\"\n[boundary]\n" + boundary + "\n" + rest, sets);
  };
  const std::string data = "start = { x = 1, y = 0, p_x = 0, p_y = 1 }\n";
  EXPECT_EQ(refused(data + "duration = 2"), "");
  EXPECT_EQ(
      refused(data + "end = { y = 1 }\nduration = 2"),
      "scene.toml:5:13: 'start' gives every coordinate and every momentum: these initial data determine the "
      "motion, and nothing can be given of 'y' at the end; leave 'end' out, or give at the start either the "
      "coordinates or the momenta");
  EXPECT_EQ(refused(data + "end = { p_x = 1 }\nduration = 2").substr(0, 17), "scene.toml:5:15: ");
  EXPECT_EQ(
      refused("start = { x = 1, p_x = 0, p_y = 1 }\nduration = 2"),
      "scene.toml:4:24: 'x' and 'p_x' are both given at this end; leave one of them out, it follows; for "
      "initial data the start needs both of every coordinate, and 'y' is missing");
  EXPECT_EQ(
      refused("start = { x = 1, y = 0, p_x = 0 }\nduration = 2"),
      "scene.toml:4:31: 'x' and 'p_x' are both given at this end; leave one of them out, it follows; for "
      "initial data the start needs both of every coordinate, and 'p_y' is missing");
  EXPECT_EQ(refused("start = { x = 1 }\nend = { x = 1, y = 0, p_x = 0, p_y = 1 }\nduration = 2"),
            "scene.toml:5:29: 'x' and 'p_x' are both given at this end; leave one of them out, it follows");
  EXPECT_NE(refused(data + "duration = \"free\"\nenergy = -0.5", "[guess]\nduration = 2\n")
                .find("must be a number"),
            std::string::npos);
  EXPECT_NE(refused(data + "duration = 2", "[guess]\nx = \"1\"\n").find("leave [guess] out"),
            std::string::npos);
  EXPECT_NE(refused(data + "duration = 2", "[search]\nsolutions = 2\n").find("leave [search] out"),
            std::string::npos);
  EXPECT_NE(
      refused(data + "duration = 2", "[continuation]\nparameter = \"mu\"\nto = 2\n").find("families are"),
      std::string::npos);
  EXPECT_NE(refused(data + "duration = 2", "", {"boundary.energy=1"}), "");
}

TEST_F(Scenes, EndsOfArraysAreFormulasInTheIndex) {
  const Study s =
      study(masses +
                "[boundary]\nstart = { q = \"k*i\", p_x = 0.5 }\nend = { p_q = [\"k\", 2, \"-i\"] }\n"
                "duration = \"k + m[2]\"\n",
            {"boundary.start.q[2]=-1"});
  EXPECT_EQ(fixed(s, 1), 4.0);
  EXPECT_EQ(fixed(s, 2), -1.0);
  EXPECT_EQ(fixed(s, 3), 12.0);
  EXPECT_EQ(s.problem.boundary.momenta, (std::vector<double>{0.5, 0, 0, 0, 0, 4, 2, -3}));
  EXPECT_EQ(s.problem.ends.free, 5);
}

TEST_F(Scenes, DefinitionsStandInEveryFormula) {
  const Study s = study(
      "[system]\ncoordinates = [\"a\"]\nparameters = { l = 2.0, g = \"4*l\", a0 = \"angle/2\" }\n"
      "definitions = { X = \"l*sin(a)\", Y = \"-l*cos(a)\", angle = \"pi/l\", period = \"2*pi*sqrt(l/g)\" }\n"
      "lagrangian = \"(X'^2 + Y'^2)/2 - g*Y\"\n"
      "[boundary]\nstart = { a = \"a0\" }\nend = { a = \"angle\" }\nduration = \"period/2\"\n"
      "[guess]\na = \"angle*(1 + t/T)/2\"\n");
  EXPECT_DOUBLE_EQ(fixed(s, 0), std::acos(-1.0) / 4);
  EXPECT_DOUBLE_EQ(fixed(s, 1), std::acos(-1.0) / 2);
  EXPECT_DOUBLE_EQ(s.problem.duration.value, std::acos(-1.0) / 2);
  EXPECT_DOUBLE_EQ(s.system.parameters.at("g").value[0], 8);
}

TEST_F(Scenes, VelocitiesAsKeysAreQuoted) {
  EXPECT_EQ(message("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\n"
                    "start = { x = 0, x' = 1 }\nduration = 1\n"),
            "scene.toml:5:19: a key with a prime, as a velocity has, is written in quotes: \"x'\" = …");
}

TEST_F(Scenes, ErrorsOfDefinitionsPointToThem) {
  EXPECT_EQ(
      message("[system]\ncoordinates = [\"x\"]\ndefinitions = { d = \"2*dd\" }\nlagrangian = \"x'^2/2\"\n"
              "[boundary]\nstart = { x = \"d\" }\nduration = 1\n")
          .substr(0, 38),
      "scene.toml:3:24: unknown name 'dd'; di");
}

TEST_F(Scenes, NaturalConditionsAreThoseThatNothingElseGives) {
  const auto count = [&](const std::string& start) {
    return natural_conditions(
        study(masses + "[boundary]\nstart = { " + start + " }\nend = { x = 1, q = \"0\" }\nduration = 2\n")
            .problem);
  };
  EXPECT_EQ(count("x = 0, q = \"0\""), 0);
  EXPECT_EQ(count("x = 0"), 3);
  EXPECT_EQ(count("x = 0, p_q = [1, 0, 2]"), 1);
}

/// Nonlinear conditions take what is free, as constraints do: on a sphere two of three coordinates at an end.
TEST_F(Scenes, ConditionsAndConstraintsLeaveFewerNaturalConditions) {
  const auto count = [&](const std::string& system, const std::string& conditions) {
    return natural_conditions(
        study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\n"
              "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 - x^2\"\n" +
              system + "[boundary]\nconditions = [" + conditions +
              "]\nduration = 1\n[guess]\nx = \"0.6 + 0.1*t\"\ny = 0.1\nz = \"0.8 - 0.1*t\"\n")
            .problem);
  };
  EXPECT_EQ(count("", "\"x(0)^2 = 0.36\", \"x(T) = 0.7\""), 4);
  EXPECT_EQ(count("", "\"x(0)^2 = 0.36\", \"y(0) = 0.1\", \"z(0) = 0.8\", \"x(T) = 0.7\""), 2);
  const std::string sphere = "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n";
  EXPECT_EQ(count(sphere, "\"x(0)*y(0) = 0.06\""), 3);
  EXPECT_EQ(count(sphere, "\"z(0) = 0.8\", \"0.6*x(T) + 0.8*z(T) = 0.9\""), 2);
}

TEST_F(Scenes, ParametersThatNothingUses) {
  const auto refused = [&](const std::string& parameters, const std::vector<std::string>& sets = {}) {
    return message("[system]\nuse = \"pendulum\"\nparameters = { " + parameters +
                       " }\n[boundary]\nstart = { theta = 0 }\nend = { theta = 1 }\nduration = 1\n",
                   sets);
  };
  EXPECT_EQ(refused("g = 1.62, l = 2"), "");
  EXPECT_EQ(refused("G = 1.62").substr(0, 53), "scene.toml:3:16: nothing uses the parameter 'G'; the ");
  EXPECT_NE(refused("G = 1.62").find("did you mean 'g'?"), std::string::npos);
  EXPECT_EQ(refused("a = 1"), "scene.toml:3:16: nothing uses the parameter 'a'; the formulas use m, l, g");
  EXPECT_EQ(refused("g = 1", {"system.parameters.nu=2"}).substr(0, 58),
            "--set system.parameters.nu: nothing uses the parameter 'nu");
  EXPECT_EQ(refused("a = 1", {"boundary.end.theta=a"}), "");
  EXPECT_EQ(refused("a = 1", {"boundary.duration=2*a"}), "");
  EXPECT_EQ(refused("a = 1, b = \"2*a\"", {"guess.theta=b*t/T"}), "");
  EXPECT_EQ(refused("a = 1", {"continuation.parameter=a", "continuation.to=2"}), "");
}

TEST_F(Scenes, FaultsOfFormulasAreToldBeforeUnusedParameters) {
  const auto refused = [&](const std::string& lagrangian, const std::string& parameter = "k",
                           const std::string& end = "1", const std::string& more = "") {
    return message("[system]\ncoordinates = [\"x\"]\nparameters = { " + parameter +
                   " = 1 }\nlagrangian = \"" + lagrangian +
                   "\"\n[boundary]\nstart = { x = 0 }\nend = { x = " + end + " }\nduration = 1\n" + more);
  };
  EXPECT_EQ(refused("x'^2/2 - kx^2/2"), "scene.toml:4:24: unknown name 'kx'; did you mean 'k*x'?");
  EXPECT_EQ(refused("x'^2/2 - mu*x^2/2", "Mu"), "scene.toml:4:24: unknown name 'mu'; did you mean 'Mu'?");
  EXPECT_EQ(refused("x'^2/2 - /2"), "scene.toml:4:24: unexpected '/'");
  EXPECT_EQ(refused(""), "scene.toml:4:15: the formula is empty");
  EXPECT_EQ(refused("x'^2/2", "k", "\"2*kk\""), "scene.toml:7:16: unknown name 'kk'; did you mean 'k*k'?");
  EXPECT_EQ(refused("x'^2/2", "k", "1", "[path]\nconstraints = [\"x >= -kk\"]\n").substr(0, 33),
            "scene.toml:10:23: unknown name 'k");
  EXPECT_EQ(refused("x'^2/2", "k", "1", "[guess]\nx = \"t/T + kt\"\n"),
            "scene.toml:10:12: unknown name 'kt'; did you mean 'k*t'?");
  EXPECT_EQ(refused("x'^2/2", "k", "1", "[guess]\nX = \"t/T\"\n").substr(0, 40),
            "scene.toml:10:1: unknown coordinate 'X';");
  // What else is wrong may follow from the parameter.
  EXPECT_EQ(refused("x'^2/2", "k", "1", "[[waypoints]]\nat = 2\nx = 0.2\n"),
            "scene.toml:3:16: nothing uses the parameter 'k'");
  EXPECT_EQ(refused("x'^2/2"), "scene.toml:3:16: nothing uses the parameter 'k'");
}

TEST_F(Scenes, ErrorsOfFormulasPointIntoTheScene) {
  EXPECT_EQ(
      message(masses + "[boundary]\nstart = { x = \"2*kk\" }\nduration = 2\n").rfind("scene.toml:7:18: ", 0),
      0u);
  std::string misspelt = masses;
  misspelt.replace(misspelt.find("sum(i, 1, 3, q[i]^2/2)"), 22, "sinn(x)");
  const std::string text = message(misspelt + ends);
  EXPECT_EQ(text.rfind("scene.toml:4:32: ", 0), 0u) << text;
  EXPECT_NE(text.find("did you mean 'sin'"), std::string::npos) << text;
}

TEST_F(Scenes, CyclicDefinitionsAreNamed) {
  const std::string text = message(
      "[system]\ncoordinates = [\"x\"]\ndefinitions = { a = \"b + 1\", b = \"a + x\" }\nlagrangian = "
      "\"x'^2/2 - a\"\n" +
      ends);
  EXPECT_EQ(text.rfind("scene.toml:3:", 0), 0u) << text;
  const auto unused = [&](const std::string& definitions) {
    return message("[system]\ncoordinates = [\"x\"]\ndefinitions = { " + definitions +
                   " }\nlagrangian = \"x'^2/2\"\n" + ends);
  };
  EXPECT_EQ(unused("r = \"r + 1\""), "scene.toml:3:22: definitions form a cycle: r -> r");
  EXPECT_EQ(unused("a = \"b\", b = \"a\""), "scene.toml:3:31: definitions form a cycle: a -> b -> a");
  EXPECT_EQ(unused("a = \"b\", b = \"x\""), "");
}

TEST_F(Scenes, Durations) {
  EXPECT_EQ(message(masses + "[boundary]\nduration = -2\n"),
            "scene.toml:7:12: duration = -2; it must be positive");
  EXPECT_EQ(message(masses + "[boundary]\nduration = \"k - 4\"\n"),
            "scene.toml:7:12: duration = 0; it must be positive");
  EXPECT_EQ(message(masses + "[boundary]\nduration = \"fre\"\n").rfind("scene.toml:7:13: ", 0), 0u);
  const std::string driven =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + x*cos(t)\"\n[boundary]\nstart = { x = 0 }\n"
      "duration = \"free\"\nenergy = 1\n[guess]\nduration = 1\n";
  EXPECT_EQ(message(driven), "scene.toml:6:12: a free duration needs a Lagrangian that does not depend on t");
}

TEST_F(Scenes, FreeDurationsAreClosed) {
  const Study energy =
      study(masses + "[boundary]\nduration = \"free\"\nenergy = \"k/2\"\n[guess]\nduration = \"k/8\"\n");
  EXPECT_TRUE(energy.problem.duration.free);
  EXPECT_EQ(energy.problem.duration.energy, 2.0);
  EXPECT_EQ(energy.problem.duration.value, 0.5);
  const Study where = study(
      masses + "[boundary]\nduration = \"free\"\nwhere = \"x(0)*q[2](T) = 3\"\n[guess]\nduration = 1\n");
  std::vector<double> start{2, 0, 0, 0}, end{0, 0, 5, 0}, gradient(8);
  EXPECT_EQ(where.problem.duration.where(start, end, gradient), 7.0);
  EXPECT_EQ(gradient, (std::vector<double>{5, 0, 0, 0, 0, 0, 2, 0}));
  EXPECT_EQ(message(masses + "[boundary]\nduration = \"free\"\nenergy = 1\n[guess]\nduration = -1\n"),
            "scene.toml:10:12: duration = -1; it must be positive");
}

TEST_F(Scenes, ConditionsAreLinearRelations) {
  const Study s =
      study(masses +
            "[boundary]\nconditions = [\"x(0) = k/2\", \"q[1](0) + q[2](0) = 0\", \"x(T) = -x(0)\"]\n"
            "duration = 6.0\n");
  EXPECT_EQ(s.problem.boundary.rows, 3);
  EXPECT_EQ(fixed(s, 0), 2.0);
  EXPECT_EQ(fixed(s, 4), -2.0);
  EXPECT_EQ(s.problem.ends.free, 5);
  EXPECT_EQ(
      message(masses +
              "[boundary]\nconditions = [\"x(0) + x(T) = 1\", \"x(0) = 1\",\n \"x(T) = 1\"]\nduration = 6\n"),
      "scene.toml:8:3: this condition contradicts the ones before it");
  EXPECT_EQ(
      message(masses +
              "[boundary]\nconditions = [\"x(0) + x(T) = 1\", \"x(0) = 1\",\n \"x(T) = 0\"]\nduration = 6\n"),
      "scene.toml:8:3: this condition follows from the ones before it; leave it out");
}

TEST_F(Scenes, PeriodicUpToASymmetry) {
  const auto periodic = [](const std::string& lagrangian, const std::string& map) {
    return "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"" + lagrangian +
           "\"\n[boundary]\nperiodic = true\n" + map +
           "duration = 3\n[guess]\nx = \"cos(2*pi*t/T)\"\ny = \"sin(2*pi*t/T)\"\n";
  };
  const std::string round = "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)";
  const Study plain = study(periodic(round, ""));
  EXPECT_TRUE(plain.problem.periodic);
  EXPECT_EQ(plain.problem.ends.free, 2);
  EXPECT_EQ(message(periodic(round, "map = { x = \"-y\", y = \"x\" }\n")), "");
  EXPECT_EQ(message(periodic("x'^2/2 + y'^2/2 + cos(x)", "map = { x = \"x + 2*pi\" }\n")), "");
  EXPECT_EQ(message(periodic("x'^2/2 + y'^2/2 - y", "map = { y = \"y + 1\" }\n")), "");  // but for a constant
  EXPECT_EQ(message(periodic("x'^2/2 + y'^2/2 + x*cos(pi*t/3)", "map = { x = \"-x\" }\n")),
            "");  // from t to t + T
  const std::string refused =
      message(periodic("x'^2/2 + y'^2/2 + x^3", "map = { y = \"-y\", x = \"-x\" }\n"));
  EXPECT_EQ(refused.rfind("scene.toml:6:9: the map changes the Lagrangian: the force on x changes by", 0), 0u)
      << refused;
  EXPECT_NE(message(periodic(round, "map = { x = \"x + 1e-3*y\" }\n")), "");
  EXPECT_NE(message(periodic(round, "map = { x = 0 }\n")), "");
  EXPECT_EQ(message(periodic(round, "map = { x = \"x^2\" }\n")).rfind("scene.toml:6:14: ", 0), 0u);
}

namespace {

/// x'²/2 − 2x² with a drive; the duration stands in line 7.
std::string driven(const std::string& drive, const std::string& duration, const std::string& more = "") {
  const std::string parameters = drive.find("w") == std::string::npos ? "{}" : "{ w = 3.0 }";
  return "[system]\ncoordinates = [\"x\"]\nparameters = " + parameters +
         "\nlagrangian = \"x'^2/2 - 2*x^2 + " + drive +
         "\"\n[boundary]\nperiodic = true\nduration = " + duration +
         "\n[guess]\nx = \"0.3*cos(2*pi*t/T)\"\n" + more;
}

}  // namespace

TEST_F(Scenes, PeriodicWhereLIsNot) {
  const std::string refused = message(driven("0.5*x*cos(1.4*pi*t)", "1"));
  EXPECT_EQ(
      refused.rfind("scene.toml:7:12: L does not repeat after the duration 1: the force on x changes by ", 0),
      0u)
      << refused;
  EXPECT_NE(refused.find("L repeats after 1.42857142857143: give that duration"), std::string::npos)
      << refused;
  EXPECT_EQ(message(driven("0.5*x*cos(1.4*pi*t)", "1.42857142857143")), "");
  EXPECT_NE(message(driven("x*exp(0.2*t)", "1")), "");
  EXPECT_EQ(message(driven("x*cos(w*t)", "\"2*pi/w\"")), "");
}

/// A duration that does not follow the drive is right at one frequency only.
TEST_F(Scenes, DurationsFollowTheDrive) {
  const std::string family = "[continuation]\nparameter = \"w\"\nto = ";
  EXPECT_EQ(message(driven("x*cos(w*t)", "\"2*pi/w\"", family + "4.0\n")), "");
  for (const char* to : {"4.0", "6.0"}) {  // 6: a period again
    const std::string fixed = message(driven("x*cos(w*t)", "\"2*pi/3\"", family + to + "\n"));
    EXPECT_EQ(fixed.rfind("scene.toml:11:14: at w = 3.00", 0), 0u) << fixed;
    EXPECT_NE(fixed.find("as a formula of w"), std::string::npos) << fixed;
  }
}

/// q'' = −4q + sin t: sin t/3 + a cos 2t + b sin 2t for all a and b. The nearest to the guess has its a and
/// b.
TEST_F(Scenes, OrbitsOfAFamilyThatIsDriven) {
  const std::string driven =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - 2*x^2 + x*sin(t)\"\n"
      "[boundary]\nperiodic = true\nduration = \"2*pi\"\n";
  const Solution found = run(study(driven + "[guess]\nx = \"0.3*sin(t) + 0.2*cos(2*t)\"\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_NE(found.message.find("one of a family of orbits"), std::string::npos) << found.message;
  EXPECT_EQ(found.nullity, 2);
  double q = 0, v = 0;
  found.trajectory.at(1, {&q, 1}, {&v, 1});
  EXPECT_NEAR(q, std::sin(1.0) / 3 + 0.2 * std::cos(2.0), 1e-8);
}

/// A drive of a third of their frequency hardly holds the phase of large oscillations: orbits are isolated
/// though their second variation is nearly singular, and no path between them is one.
TEST_F(Scenes, NoFamilyWhereAPhaseIsHardlyHeld) {
  for (const auto& [frequency, slope] : {std::pair{1.5, -8.4956}, {2.0, -15.4187}}) {
    const Study driven = study(fmt::format(
        "[system]\ncoordinates = [\"x\"]\nparameters = {{ w = {} }}\nlagrangian = \"x'^2/2 - x^2/2 - x^4/4 + "
        "0.3*x*cos(w*t)\"\n[boundary]\nperiodic = true\nduration = \"2*pi/w\"\n[guess]\nstate = {{ x = -0.2, "
        "\"x'\" = {} }}\n[solve]\ntolerance = 1e-12\n",
        frequency, slope));
    const Solution found = run(driven);
    EXPECT_EQ(found.message.find("family of orbits of"), std::string::npos) << found.message;
    if (!found.converged()) continue;
    std::vector<double> q(1), v(1);
    found.trajectory.at(0, q, v);
    const Flight flight = fly(*driven.problem.lagrangian, q, v, std::vector<double>{found.duration()});
    EXPECT_NEAR(flight.q[0], q[0], 1e-11) << frequency;
  }
}

/// q'' = −q + sin t has no orbit of the period 2π: sin t does work on the motions without it.
TEST_F(Scenes, ResonanceIsTold) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2 + x*sin(t)\"\n"
                "[boundary]\nperiodic = true\nduration = \"2*pi\"\n[guess]\nx = \"0.3*sin(t)\"\n"));
  EXPECT_EQ(found.status, Status::no_solution_near);
  EXPECT_NE(found.message.find("in resonance"), std::string::npos) << found.message;
}

/// A wall of two fields, f = tanh t and g = 0, attains the bound 4/3 of its action. The second variation by g
/// has an eigenvalue of about exp(−2 r T): no sign of it is known in a long time.
TEST_F(Scenes, WallsBesideASoftField) {
  for (const double duration : {40.0, 150.0, 1000.0}) {
    const Solution found = run(study(fmt::format(
        "[system]\ncoordinates = [\"f\", \"g\"]\n"
        "lagrangian = \"(f'^2 + g'^2)/2 + ((1 - f^2 - r*g^2)^2 + 4*r^2*f^2*g^2)/2\"\n"
        "parameters = {{ r = 0.7 }}\n[boundary]\nstart = {{ f = -1, g = 0 }}\nend = {{ f = 1, g = 0 }}\n"
        "duration = {}\n",
        duration)));
    ASSERT_TRUE(found.converged()) << duration << ": " << found.message;
    EXPECT_NEAR(found.action, 4.0 / 3, 1e-10);
    EXPECT_EQ(found.morse_index, 0) << duration;
    EXPECT_EQ(found.nullity, 2) << duration;
    EXPECT_TRUE(found.minimizing);
  }
}

/// An encounter of the length 1e-6 comes too early or too late on an orbit whose period is known to three
/// digits.
TEST_F(Scenes, PeriodsOfStatesGivenRoughly) {
  for (const double e : {0.99, 0.9999, 0.99999})
    for (const double period : {6.2, 6.2832, 6.4}) {
      const Solution found = run(study(fmt::format(
          "[system]\nuse = \"kepler\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = -0.5\n"
          "[guess]\nstate = {{ x = {}, \"y'\" = \"-sqrt((1 - {})/(1 + {}))\" }}\nduration = {}\n",
          -1 - e, e, e, period)));
      ASSERT_TRUE(found.converged()) << e << ' ' << period << ": " << found.message;
      EXPECT_NEAR(found.duration(), 2 * std::numbers::pi, 1e-8) << e;
      EXPECT_NEAR(found.action, 3 * std::numbers::pi, 1e-8) << e;
    }
}
