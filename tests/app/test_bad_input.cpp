#include "command.hpp"

using namespace extremal::test;

namespace {

std::string with(const std::string& from, const std::string& to) {
  std::string s = pendulum;
  return s.replace(s.find(from), from.size(), to);
}

/// A scene and the beginning of its message.
struct Case {
  const char* name;
  std::string scene, message;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class BadInput : public Command, public ::testing::WithParamInterface<Case> {};

std::vector<Case> cases() {
  const std::string chain =
      "[system]\ncoordinates = [\"q[3]\"]\nlagrangian = \"sum(i, 1, 3, q[i]'^2/2)\"\n[boundary]\n";
  return {
      {"UnknownKey", with("lagrangian", "lagrangain"),
       "scene.toml:4:1: unknown key 'lagrangain' in [system]; did you mean 'lagrangian'?\n"},
      {"MisspeltFunction", with("cos(q)", "coss(q)"),
       "scene.toml:4:24: unknown function 'coss'; did you mean 'cos'?\n"},
      {"UnknownCoordinate", with("end = { q", "end = { p"), "scene.toml:7:9: unknown coordinate 'p'"},
      {"NumberOfValues", chain + "start = { q = [0, 0] }\nduration = 1\n",
       "scene.toml:5:15: 'q' has 3 elements; found 2 values\n"},
      {"IndexOutOfRangeInEnds", chain + "start = { \"q[4]\" = 0 }\nduration = 1\n",
       "scene.toml:5:11: 'q[4]' is out of range: 'q' has elements 1 to 3\n"},
      {"IndexOutOfRangeInFormula",
       "[system]\ncoordinates = [\"q[3]\"]\nlagrangian = \"sum(i, 1, 3, q[i+1]'^2/2)\"\n"
       "[boundary]\nduration = 1\n",
       "scene.toml:3:"},
      {"CyclicDefinitions",
       with("lagrangian = \"", "definitions = { a = \"b\", b = \"a\" }\nlagrangian = \"a + "),
       "scene.toml:4:"},
      {"MissingDuration", with("duration = 2.0\n", ""),
       "scene.toml:5:1: [boundary] has no duration; give a number, a formula, \"free\" or \"infinite\"\n"},
      {"NegativeDuration", with("2.0", "-2.0"), "scene.toml:8:12: duration = -2; it must be positive\n"},
      {"EnergyWithFixedDuration", pendulum + "energy = 1\n",
       "scene.toml:9:10: 'energy' closes a free duration, but duration is fixed; "},
      {"ContradictoryConditions", chain + "conditions = [\"q[1](0) = 0\", \"q[1](0) = 1\"]\nduration = 1\n",
       "scene.toml:5:31: this condition contradicts the ones before it\n"},
      {"RedundantConditions", chain + "conditions = [\"q[1](0) = 0\", \"2*q[1](0) = 0\"]\nduration = 1\n",
       "scene.toml:5:31: this condition follows from the ones before it; leave it out\n"},
      {"NotRegular", with("q'^2/2", "q'"), "scene.toml:4:14: the Lagrangian is not regular"},
      {"LengthOfAPath",
       "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(1 + x^2)*sqrt(x'^2 + y'^2)\"\n"
       "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 1, y = 1 }\nduration = 1\n",
       "scene.toml:3:14: the Lagrangian is homogeneous of degree one in the velocities: it determines the "
       "path, but not the speed along it; take L^2/2, whose extremals are the same curves\n"},
      {"LengthWithTime",
       "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(1 + t)*sqrt(x'^2 + y'^2)\"\n"
       "[boundary]\nstart = { x = 0, y = 0 }\nend = { x = 1, y = 1 }\nduration = 1\n",
       "scene.toml:3:14: the Lagrangian is homogeneous of degree one in the velocities, so its energy is "
       "zero; it depends on t, so the energy changes along an extremal; write it without t, or for a graph: "
       "sqrt(1 + x'^2) is the length of x(t)\n"},
      {"EnergyBelowThatOfAnEnd",
       "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\n"
       "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = \"free\"\nenergy = 0.1\n[guess]\nduration "
       "= 1\n",
       "scene.toml:8:10: energy = 0.1, but at the end (x = 1) it is at least 0.5, its value at rest; raise "
       "it, or move this end\n"},
      {"NotFiniteAtTheGuess", with("cos(q)", "1/q") + "[guess]\nq = \"-t*(2 - t)/2\"\n",
       "scene.toml:9:1: L is not finite on the guess at t = "},
      {"Empty", "", "scene.toml: the file is empty\n"},
      {"Binary",
       std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0",
                   10),
       "scene.toml:1:8: not a text file"},
      {"Brackets", "x = " + std::string(1'000'000, '['), "scene.toml:1:"},
      {"HugeArray", with("\"q\"", "\"q[1000000000000]\""), "scene.toml:3:"},
      {"HugeSum", with("cos(q)", "sum(i, 1, 1000000000000, q*i)"), "scene.toml:4:"},
      {"UnknownKeyOfATable", pendulum + "[path]\nto = 5\n",
       "scene.toml:10:1: unknown key 'to' in [path]; there is 'constraints'\n"},
      {"NoSolutionsWanted", pendulum + "[search]\nsolutions = 0\n",
       "scene.toml:10:13: solutions = 0; need 1 to 1000\n"},
  };
}

}  // namespace

TEST_P(BadInput, IsRefusedWithItsMessage) {
  const Outcome o = solve(GetParam().scene, {"--output", "r.json"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_EQ(o.error.rfind("error: " + GetParam().message, 0), 0u) << o.error;
  EXPECT_EQ(std::count(o.error.begin(), o.error.end(), '\n'), 1) << o.error;
  EXPECT_EQ(o.out, "");
  EXPECT_FALSE(fs::exists(folder / "r.json"));
}

INSTANTIATE_TEST_SUITE_P(Scenes, BadInput, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

TEST_F(Command, HundredMegabytesAreRefusedByTheirSize) {
  write("scene.toml", "");
  fs::resize_file(folder / "scene.toml", 100'000'000);  // sparse
  const Outcome o = extremal({"solve", "scene.toml"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_EQ(o.error, "error: scene.toml: has 100000000 bytes; at most 16777216 (16 MiB) are read\n");
}

TEST_F(Command, MillionParenthesesInEveryFormula) {
  const std::size_t million = 1'000'000;
  const std::string open(million, '('), nested = open + "q" + std::string(million, ')');
  const std::string power = [&] {
    std::string s = "2";
    for (std::size_t k = 0; k < million; ++k) s += "^2";
    return s;
  }();
  for (const std::string& formula : {open, nested, power}) {
    for (const std::string& scene : {with("cos(q)", formula), with("2.0", "\"" + formula + "\""),
                                     pendulum + "[guess]\nq = \"" + formula + "\"\n",
                                     pendulum.substr(0, pendulum.find("start")) +
                                         "duration = 1\nconditions = [\"" + formula + "\"]\n"}) {
      const Outcome o = solve(scene);
      EXPECT_EQ(o.exit, 2) << formula.substr(0, 10);
      EXPECT_EQ(o.error.rfind("error: scene.toml:", 0), 0u) << o.error.substr(0, 200);
      EXPECT_LT(o.error.size(), 500u) << o.error.substr(0, 500);
    }
  }
}

TEST_F(Command, MillionSignsAreReadInALoop) {
  EXPECT_EQ(solve(with("cos(q)", std::string(1'000'000, '-') + "cos(q)"), {"--quiet"}).exit, 0);
}
