#include "files.hpp"

using namespace extremal;
using namespace extremal::test;

TEST_F(SceneFiles, SetChangesAnyKey) {
  const std::string path = write("scene.toml", pendulum + "[guess]\nq = \"t\"\n");
  const Scene scene =
      read_scene(path, {"solve.scheme=lobatto(3)", "solve.elements=8", "boundary.end.q=\"2*pi\"",
                        "guess.q=sin(pi*t/T) = 1", "system.parameters.m=[1, 2]", "title=A = b",
                        "boundary.start={q = 5}"});
  EXPECT_EQ(scene.solve.scheme->value, "lobatto(3)");
  EXPECT_EQ(to_string(scene.solve.scheme->at), "--set solve.scheme");
  EXPECT_EQ(scene.solve.elements->value, 8);
  EXPECT_EQ(std::get<std::string>(scene.boundary.end[0].values[0].value), "2*pi");
  EXPECT_EQ(std::get<std::string>(scene.guess.formulas[0].values[0].value), "sin(pi*t/T) = 1");
  EXPECT_EQ(scene.system.parameters[0].values.size(), 2u);
  EXPECT_EQ(scene.title, "A = b");
  EXPECT_EQ(std::get<double>(scene.boundary.start[0].values[0].value), 5.0);
}

TEST_F(SceneFiles, SetKeepsTheRestOfATable) {
  const Scene scene = read_scene(write("scene.toml", pendulum), {"boundary.duration=3"});
  EXPECT_EQ(std::get<double>(scene.boundary.duration.value), 3.0);
  EXPECT_EQ(scene.boundary.start.size(), 1u);
}

TEST_F(SceneFiles, SetOfElementsAndVelocities) {
  const std::string path = write("scene.toml", pendulum);
  const Scene scene =
      read_scene(path, {"boundary.start.q[2]=1.5", "boundary.end.'q[3]'=2", "guess.state.q'=0.5"});
  EXPECT_EQ(scene.boundary.start[1].name, "q[2]");
  EXPECT_EQ(scene.boundary.end[1].name, "q[3]");
  EXPECT_EQ(scene.guess.state->at(0).name, "q'");
}

TEST_F(SceneFiles, SetOfAnElementOfAList) {
  std::string lists = pendulum;
  lists.replace(lists.find("[boundary]"), 0, "parameters = { m = [1, 2, 3] }\n");
  lists += "[guess]\nstate = { q = 1, \"q'\" = [4, 5] }\n";
  const Scene scene =
      read_scene(write("scene.toml", lists),
                 {"system.parameters.m[2]=7", "guess.state.q[2]'=8", "system.coordinates[1]=q[n]",
                  "system.parameters.n=2", "system.parameters.m[3]=2*n"});
  const Assignment& m = scene.system.parameters[0];
  EXPECT_EQ(std::get<double>(m.values[0].value), 1.0);
  EXPECT_EQ(std::get<double>(m.values[1].value), 7.0);
  EXPECT_EQ(std::get<std::string>(m.values[2].value), "2*n");
  EXPECT_EQ(to_string(m.values[1].at), "--set system.parameters.m[2]");
  EXPECT_EQ(std::get<double>(scene.guess.state->at(1).values[1].value), 8.0);
  EXPECT_EQ(scene.system.coordinates[0].value, "q[n]");
  EXPECT_EQ(message(lists, {"system.parameters.m[4]=1"}),
            "--set system.parameters.m[4]: 'm[4]' is out of range: the list has elements 1 to 3");
  EXPECT_EQ(message(lists, {"system.parameters.m[0]=1"}),
            "--set system.parameters.m[0]: 'm[0]' is out of range: the list has elements 1 to 3");
}

TEST_F(SceneFiles, SetTakesTheLastOfTwo) {
  const Scene scene = read_scene(write("scene.toml", pendulum), {"title=a", "title=b"});
  EXPECT_EQ(scene.title, "b");
}

TEST_F(SceneFiles, SetRefusals) {
  EXPECT_EQ(message(pendulum, {"solve.scheme"}), "--set solve.scheme: no '='; write key=value");
  EXPECT_EQ(message(pendulum, {"=1"}), "--set : the key has an empty part; write table.key=value");
  EXPECT_EQ(message(pendulum, {"solve..x=1"}),
            "--set solve..x: the key has an empty part; write table.key=value");
  EXPECT_EQ(message(pendulum, {"boundary.duration.x=1"}),
            "--set boundary.duration.x: 'duration' is not a table");
  EXPECT_EQ(message(pendulum, {"solve.shceme=a"}), "--set solve.shceme: unknown key 'shceme' in [solve]");
  EXPECT_EQ(message(pendulum, {"title=3"}), "--set title: 'title' must be a string, found an integer");
  EXPECT_EQ(message(pendulum, {"boundary.duration=1e999"}), "");  // no number of TOML: a formula
  std::string deep = "a";
  for (int k = 0; k < 100000; ++k) deep += ".a";
  EXPECT_NE(message(pendulum, {deep + "=1"}).find("this key has more than 64 parts"), std::string::npos);
  EXPECT_EQ(message(pendulum + "[solve]\ntolerance = 1e-3\nscheme = \"midpoint\"\n", {"solve.elements=4"}),
            "--set solve.elements: 'elements' and 'tolerance' exclude each other: 'elements' fixes the "
            "discretisation and with it the error");
}
