#include "command.hpp"

using namespace extremal::test;

namespace {

const std::string spring =
    "[about]\nsummary = \"A spring of its own.\"\nunits = \"kg, m, s\"\ninvariants = [\"energy\", "
    "\"phase\"]\n"
    "sources = \"R. Hooke, 1678\"\n"
    "[system]\ncoordinates = [\"x\", \"y[2]\"]\nparameters = { k = 2.5, m = [1, 2] }\n"
    "definitions = { potential = \"k*x^2/2\" }\nlagrangian = \"m[1]*x'^2/2 - potential\"\n";

/// The environment's folders are the test's own.
class Listing : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    ::setenv("EXTREMAL_PROBLEMS", folder.c_str(), 1);
    fs::create_directory(folder / "systems");
    fs::create_directory(folder / "scenes");
    write("systems/spring.toml", spring);
    write("scenes/bounce.toml", "[system]\nuse = \"spring\"\n[boundary]\nduration = 1\n");
    write("scenes/other.toml", "[system]\nuse = \"kepler\"\n[boundary]\nduration = 1\n");
  }
  void TearDown() override {
    ::unsetenv("EXTREMAL_PROBLEMS");
    Command::TearDown();
  }
};

}  // namespace

TEST_F(Listing, NamesSystemsSchemesAndMethods) {
  const Outcome o = extremal({"list"});
  EXPECT_EQ(o.exit, 0);
  for (const char* text : {"spring", "A spring of its own.", "midpoint", "lobatto", "newton"})
    EXPECT_NE(o.out.find(text), std::string::npos) << text;
}

TEST_F(Listing, DescribesOneSystem) {
  for (const char* name : {"spring", "spring.toml"}) {
    const Outcome o = extremal({"list", name});
    EXPECT_EQ(o.exit, 0) << o.error;
    for (const char* text :
         {"system         spring\n", "units          kg, m, s\n",
          "invariants     energy\n               phase\n", "sources        R. Hooke, 1678\n",
          "coordinates    x, y[2]\n", "parameters     k = 2.5\n               m = [1, 2]\n",
          "definitions    potential = k*x^2/2\n", "Lagrangian     m[1]*x'^2/2 - potential\n"})
      EXPECT_NE(o.out.find(text), std::string::npos) << text << "\n" << o.out;
    EXPECT_NE(o.out.find("scenes         " + (folder / "scenes/bounce.toml").string() + "\n"),
              std::string::npos)
        << o.out;
    EXPECT_EQ(o.out.find("other.toml"), std::string::npos) << o.out;
  }
}

TEST_F(Listing, NamesTheNearestSystem) {
  const Outcome o = extremal({"list", "sprnig"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_EQ(o.out, "");
  EXPECT_EQ(
      o.error,
      "error: extremal list: there is no system 'sprnig' among those that 'extremal list' names; did you "
      "mean 'spring'?\n");
}

TEST_F(Listing, EverySystemOfTheLibraryHasAScene) {
  const Outcome names = extremal({"completion", "systems"});
  std::stringstream lines(names.out);
  int systems = 0;
  for (std::string name; std::getline(lines, name); ++systems) {
    const Outcome o = extremal({"list", name});
    EXPECT_EQ(o.exit, 0) << o.error;
    EXPECT_NE(o.out.find("\nscenes "), std::string::npos) << name;
  }
  EXPECT_GT(systems, 20);
}

TEST_F(Command, CheckPrintsTheStructure) {
  write("scene.toml", pendulum);
  const Outcome o = extremal({"check", "scene.toml"});
  EXPECT_EQ(o.exit, 0) << o.error;
  for (const char* text :
       {"1: q", "energy is conserved", "constant mass", "separable", "∂L/∂q", "∂²L/∂q∂q", "instructions"})
    EXPECT_NE(o.out.find(text), std::string::npos) << text << "\n" << o.out;
  EXPECT_EQ(o.out.find("not fixed"), std::string::npos) << o.out;
}

TEST_F(Command, CheckTellsWhatIsAskedOfThePath) {
  write("scene.toml",
        "[system]\ncoordinates = ['x', 'y']\nparameters = { k = 1.0 }\nlagrangian = \"(x'^2 + y'^2)/2 - "
        "k*y^2/2\"\n"
        "[boundary]\nstart = { x = 0, y = 0 }\nend = { y = 1 }\nduration = 2\nintegrals = ['x*y = "
        "0.5']\n"
        "unknowns = { k = 1.0 }\nwhere = ['x(T) = 1']\n[[waypoints]]\nat = 'free'\ny = 0.25\n");
  const Outcome o = extremal({"check", "scene.toml"});
  EXPECT_EQ(o.exit, 0) << o.error;
  EXPECT_NE(o.out.find("integrals      x*y = 0.5\n"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("unknowns       k (from 1)\n"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("waypoints      t free, from "), std::string::npos) << o.out;
}

TEST_F(Command, ParametersAndNaturalEndsArePrinted) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { mu = 2, m = [1, 0.5] }\n"
      "lagrangian = \"m[1]*x'^2/2 + m[2]*y'^2/2 - mu*x^2/2\"\n"
      "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = 0.5 }\nduration = 1\n";
  write("scene.toml", scene);
  const Outcome check = extremal({"check", "scene.toml"});
  EXPECT_EQ(check.exit, 0) << check.error;
  for (const char* text : {"parameters     m = [1, 0.5]\n               mu = 2\n", "1 natural",
                           "not fixed      at the start none; at the end y(T)\n"})
    EXPECT_NE(check.out.find(text), std::string::npos) << text << "\n" << check.out;
  const Outcome solved = extremal({"solve", "scene.toml"});
  EXPECT_EQ(solved.exit, 0) << solved.error;
  EXPECT_NE(solved.out.find("boundary        1 natural condition\n"), std::string::npos) << solved.out;
  EXPECT_EQ(solve(pendulum).out.find("natural"), std::string::npos);
}
