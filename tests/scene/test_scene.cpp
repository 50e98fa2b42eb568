#include "files.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// `pendulum` with one piece of it replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string s = pendulum;
  return s.replace(s.find(from), from.size(), to);
}

}  // namespace

TEST_F(SceneFiles, TextsWithoutQuotes) {
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string scene = pendulum;
    return message(scene.replace(scene.find(from), from.size(), to));
  };
  EXPECT_EQ(refused("\"q'^2/2 + cos(q)\"", "q'^2/2 + cos(q)"),
            "scene.toml:3:14: texts and formulas are written in quotes: \"q'^2/2 + cos(q)\"");
  EXPECT_EQ(refused("duration = 2", "duration = 2*pi  # s"),
            "scene.toml:7:12: texts and formulas are written in quotes: \"2*pi\"");
  EXPECT_EQ(refused("duration = 2", "duration = sqrt(2)"),
            "scene.toml:7:12: texts and formulas are written in quotes: \"sqrt(2)\"");
  EXPECT_EQ(refused("q = 1 }", "q = -pi/2 }"),
            "scene.toml:6:13: texts and formulas are written in quotes: \"-pi/2\"");
  EXPECT_EQ(refused("duration = 2", "duration 2"),
            "scene.toml:7:1: '=' is missing between a key and its value; write duration = 2");
  EXPECT_EQ(refused("\"q'^2/2 + cos(q)\"", "q'^2/2 + cos(q)\""),
            "scene.toml:3:14: texts and formulas are written in quotes: \"q'^2/2 + cos(q)\"");
  EXPECT_EQ(refused("[\"q\"]", "[q]"), "scene.toml:2:16: texts and formulas are written in quotes: \"q\"");
}

TEST_F(SceneFiles, EveryKeyIsRead) {
  const Scene scene = read_scene(write("scene.toml", R"(title = "All"
[system]
coordinates = ["x", "q[n]"]
parameters = { n = 2, m = [1.5, 2], mu = 1 }
definitions = { r = "x^2" }
lagrangian = "x'^2"
curvature = 4
[boundary]
start = { x = "mu", q = [1, "2*mu"] }
end."q[2]" = 3.5
duration = "free"
where = "x(0) = 1"
[guess]
q = ["t", "t/T"]
x = 2
duration = "2*mu"
[solve]
scheme = "midpoint"
elements = 64
method = "newton"
)"));
  EXPECT_EQ(scene.title, "All");
  ASSERT_EQ(scene.system.coordinates.size(), 2u);
  EXPECT_EQ(scene.system.coordinates[1].value, "q[n]");
  EXPECT_EQ(to_string(position(scene.system.coordinates[1], 2)).substr(folder.string().size() + 1),
            "scene.toml:3:24");
  ASSERT_EQ(scene.system.parameters.size(), 3u);
  EXPECT_EQ(scene.system.parameters[1].name, "m");
  EXPECT_TRUE(scene.system.parameters[1].list);
  EXPECT_EQ(std::get<double>(scene.system.parameters[1].values[1].value), 2.0);
  EXPECT_EQ(scene.system.curvature->value, 4.0);
  EXPECT_EQ(std::get<std::string>(scene.boundary.start[1].values[1].value), "2*mu");
  EXPECT_EQ(scene.boundary.end[0].name, "q[2]");
  EXPECT_TRUE(scene.boundary.free);
  EXPECT_EQ(scene.boundary.where->value, "x(0) = 1");
  ASSERT_EQ(scene.guess.formulas.size(), 2u);
  EXPECT_EQ(scene.guess.formulas[0].name, "q");
  EXPECT_EQ(std::get<double>(scene.guess.formulas[1].values[0].value), 2.0);
  EXPECT_TRUE(scene.guess.duration->formula());
  EXPECT_EQ(scene.solve.scheme->value, "midpoint");
  EXPECT_EQ(scene.solve.elements->value, 64);
}

TEST_F(SceneFiles, UnknownKeys) {
  EXPECT_EQ(message(with("lagrangian", "lagrangain")),
            "scene.toml:3:1: unknown key 'lagrangain' in [system]");
  EXPECT_EQ(message("titel = \"a\"\n" + pendulum), "scene.toml:1:1: unknown key 'titel'");
  EXPECT_EQ(message("[sovle]\n" + pendulum), "scene.toml:1:2: unknown key 'sovle'");
  try {
    read_scene(write("scene.toml", with("lagrangian", "lagrangain")));
    FAIL();
  } catch (const UnknownName& e) {
    EXPECT_EQ(e.name, "lagrangain");
    EXPECT_NE(std::find(e.known.begin(), e.known.end(), "lagrangian"), e.known.end());
  }
}

TEST_F(SceneFiles, KeysThatAreCalledOtherwise) {
  EXPECT_EQ(message(with("duration", "period")),
            "scene.toml:7:1: unknown key 'period' in [boundary]; did you mean 'duration'?");
  EXPECT_EQ(message(with("end", "finish")),
            "scene.toml:6:1: unknown key 'finish' in [boundary]; did you mean 'end'?");
  EXPECT_EQ(message(with("lagrangian", "L")),
            "scene.toml:3:1: unknown key 'L' in [system]; did you mean 'lagrangian'?");
}

TEST_F(SceneFiles, WrongTypes) {
  EXPECT_EQ(message(with("[\"q\"]", "\"q\"")),
            "scene.toml:2:15: 'coordinates' in [system] must be a list of strings, found a string; write it "
            "as in coordinates = [\"r\", \"q[3]\"]");
  EXPECT_EQ(message(with("[\"q\"]", "[\"q\", 2]")),
            "scene.toml:2:21: element 2 of 'coordinates' in [system] must be a string, found an integer");
  EXPECT_EQ(message(with("= 2", "= [2]")),
            "scene.toml:7:12: 'duration' in [boundary] must be a number or a formula, found a list");
  EXPECT_EQ(message(with("= 2", "= nan")),
            "scene.toml:7:12: 'duration' in [boundary] must be finite, found nan");
  EXPECT_EQ(message(with("{ q = 1 }", "1")),
            "scene.toml:6:7: 'end' in [boundary] must be a table, found an integer; write it as in "
            "end = { x = \"-mu\", \"q[2]\" = 0.5 }");
  EXPECT_EQ(message(with("q = 1", "q = true")),
            "scene.toml:6:13: 'q' in [boundary.end] must be a number, a formula or a list of them, found a "
            "boolean");
  EXPECT_EQ(message("boundary = 1\n" + pendulum.substr(0, pendulum.find("[boundary]"))),
            "scene.toml:1:12: [boundary] must be a table, found an integer; write it as in boundary.duration "
            "= 2.5");
  EXPECT_EQ(message(pendulum + "[solve]\nscheme = \"midpoint\"\nelements = 6.5\n"),
            "scene.toml:10:12: 'elements' in [solve] must be an integer, found a number");
}

TEST_F(SceneFiles, MissingKeys) {
  EXPECT_EQ(message(with("duration = 2\n", "")),
            "scene.toml:4:1: [boundary] has no duration; give a number, a formula, \"free\" or \"infinite\"");
  EXPECT_EQ(message(with("coordinates = [\"q\"]\n", "")),
            "scene.toml:1:1: [system] has no 'coordinates'; list them, or name a system by 'use'");
  EXPECT_EQ(
      message(with("lagrangian = \"q'^2/2 + cos(q)\"\n", "")),
      "scene.toml:1:1: [system] has no 'lagrangian'; write one, or a 'hamiltonian', or name a system by "
      "'use'");
  EXPECT_EQ(message(with("lagrangian", "hamiltonian")), "");
  EXPECT_EQ(message(pendulum.substr(0, pendulum.find("[boundary]"))),
            "scene.toml: the table [boundary] is missing");
}

TEST_F(SceneFiles, Contradictions) {
  EXPECT_EQ(message(pendulum + "[solve]\nelements = 4\nscheme = \"midpoint\"\ntolerance = 1e-3\n"),
            "scene.toml:11:1: 'tolerance' and 'elements' exclude each other: 'elements' fixes "
            "the discretisation and with it the error");
  EXPECT_EQ(message(pendulum + "[solve]\nelements = 4\n"),
            "scene.toml:9:1: 'elements' needs 'scheme': the number of elements alone does not fix a "
            "discretisation");
  EXPECT_EQ(
      message(pendulum + "energy = 1\n"),
      "scene.toml:8:10: 'energy' closes a free duration, but duration is fixed; write duration = \"free\" or "
      "leave 'energy' out");
  EXPECT_EQ(
      message(with("= 2\n", "= \"free\"\nenergy = 1\nwhere = \"q(0) = 1\"\n")),
      "scene.toml:9:1: 'where' and 'energy' exclude each other: exactly one of them closes a free duration");
  EXPECT_EQ(message(pendulum + "[guess]\nduration = 2.4\n"),
            "scene.toml:9:12: 'duration' in [guess] needs duration = \"free\" in [boundary]; write that, or "
            "leave the guess out");
  EXPECT_EQ(message(pendulum + "periodic = true\n"),
            "scene.toml:8:1: 'periodic' and 'start' exclude each other: a periodic orbit has no fixed ends; "
            "'where' selects it");
  EXPECT_EQ(message(pendulum + "periodic = false\n"), "");
  EXPECT_EQ(
      message(pendulum + "conditions = [\"q(0) = 1\"]\n"),
      "scene.toml:8:1: 'conditions' and 'start' exclude each other: write the fixed ends as conditions too");
  EXPECT_EQ(message(pendulum + "map = { q = \"-q\" }\n"),
            "scene.toml:8:1: 'map' needs 'periodic': a map relates the ends of a periodic orbit");
  EXPECT_EQ(message(pendulum + "[guess]\nq = \"t\"\nfile = \"a.csv\"\n"),
            "scene.toml:10:1: 'file' and 'q' exclude each other: a guess has one source");
  EXPECT_EQ(
      message("[system]\nuse = \"a\"\ncoordinates = [\"x\"]\n[boundary]\nduration = 1\n"),
      "scene.toml:3:1: 'coordinates' and 'use' exclude each other: the system file declares the coordinates");
  EXPECT_EQ(message(with("start = { q = 0 }\nend = { q = 1 }", "periodic = true")),
            "scene.toml:4:1: a periodic orbit needs a guess: formulas, a file or a state in [guess]");
}

TEST_F(SceneFiles, NumbersOutOfRange) {
  EXPECT_EQ(message(pendulum + "[solve]\nelements = 0\nscheme = \"midpoint\"\n"),
            "scene.toml:9:12: elements = 0; need 1 to 1000000000");
  EXPECT_EQ(message(pendulum + "[solve]\ntolerance = -1e-3\n"),
            "scene.toml:9:13: tolerance = -0.001; need more than 0 and less than 1");
}

TEST_F(SceneFiles, Search) {
  const auto search = [&](const std::string& lines) { return pendulum + "[search]\n" + lines; };
  for (const int k : {1, 12, 1000}) {
    const Scene scene = read_scene(write("scene.toml", search("solutions = " + std::to_string(k) + "\n")));
    ASSERT_TRUE(scene.search);
    EXPECT_EQ(scene.search->solutions.value, k);
  }
  EXPECT_FALSE(read_scene(write("scene.toml", pendulum)).search);
  EXPECT_EQ(message(search("solutions = 0\n")), "scene.toml:9:13: solutions = 0; need 1 to 1000");
  EXPECT_EQ(message(search("solutions = 1001\n")), "scene.toml:9:13: solutions = 1001; need 1 to 1000");
  EXPECT_EQ(message(search("solutions = 2.5\n")),
            "scene.toml:9:13: 'solutions' in [search] must be an integer, found a number");
  EXPECT_EQ(message(search("solution = 2\n")), "scene.toml:9:1: unknown key 'solution' in [search]");
  EXPECT_EQ(message(search("")),
            "scene.toml:8:1: [search] has no 'solutions'; give the largest number of extremals");
}

TEST_F(SceneFiles, ContinuationIsRead) {
  const auto continuation = [&](const std::string& lines) { return pendulum + "[continuation]\n" + lines; };
  const Scene scene =
      read_scene(write("scene.toml", continuation("parameter = \"duration\"\nto = 3\nswitch = false\n")));
  ASSERT_TRUE(scene.continuation);
  EXPECT_EQ(scene.continuation->parameter.value, "duration");
  EXPECT_EQ(scene.continuation->to.value, 3);
  EXPECT_FALSE(scene.continuation->points);
  const std::string fine = "parameter = \"duration\"\nto = 3\n";
  EXPECT_EQ(message(continuation("to = 3\n")),
            "scene.toml:8:1: [continuation] has no parameter; give \"duration\", \"energy\" or the name of a "
            "parameter of the system");
  EXPECT_EQ(message(continuation("parameter = \"duration\"\n")),
            "scene.toml:8:1: [continuation] has no 'to'; give the last value of the parameter");
  EXPECT_EQ(message(continuation(fine + "points = 1\n")), "scene.toml:11:10: points = 1; need 2 to 100000");
  EXPECT_FALSE(scene.continuation->switching);
  EXPECT_EQ(message(continuation(fine + "switch = 1\n")),
            "scene.toml:11:10: 'switch' in [continuation] must be true or false, found an integer");
  EXPECT_EQ(message(continuation(fine + "step = 1\n")),
            "scene.toml:11:1: unknown key 'step' in [continuation]");
}

TEST_F(SceneFiles, PathsAndMethods) {
  EXPECT_EQ(message(pendulum + "[path]\nx = 1\n"), "scene.toml:9:1: unknown key 'x' in [path]");
  EXPECT_EQ(message(pendulum + "[solve]\nmethod = \"newtom\"\n"), "scene.toml:9:11: unknown method 'newtom'");
}
