#include "command.hpp"

using namespace extremal::test;

namespace {

using Init = Command;

TEST_F(Init, ASceneOfASystemSolves) {
  for (const std::string system : {"kepler", "pendulum", "nbody", "duffing"}) {
    const Outcome written = extremal({"init", system});
    ASSERT_EQ(written.exit, 0) << written.error;
    EXPECT_EQ(written.out, system + ".toml\n");
    const std::string scene = read_text(folder / (system + ".toml"));
    EXPECT_NE(scene.find("# Conditions at the ends, and the duration.\n[boundary]"), std::string::npos);
    EXPECT_NE(scene.find("# summary: "), std::string::npos);
    const Outcome checked = extremal({"check", system + ".toml"});
    EXPECT_EQ(checked.exit, 0) << system << checked.error;
  }
}

TEST_F(Init, ASystemOfTheUsersOwnHasOneToo) {
  write("wagon.toml",
        "[about]\nsummary = 'Wagons'\n[system]\ncoordinates = ['x', 'q[3]']\n"
        "lagrangian = \"x'^2/2 + sum(i, 1, 3, q[i]'^2/2)\"\n");
  const Outcome written = extremal({"init", "wagon", "--output", "mine.toml"});
  ASSERT_EQ(written.exit, 0) << written.error;
  const Outcome solved = extremal({"solve", "mine.toml"});
  EXPECT_EQ(solved.exit, 0) << solved.error << read_text(folder / "mine.toml");
  const Outcome refused = extremal({"init", "wagon"});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.error.find("'wagon.toml' is there already"), std::string::npos) << refused.error;
}

TEST_F(Init, StandardOutputHasTheSceneAlone) {
  const Outcome o = extremal({"init", "kepler", "--output", "-"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_NE(o.out.find("use = \"kepler\""), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "kepler.toml"));
}

TEST_F(Init, AnUnknownNameIsToldWithWhatMayBeMeant) {
  const auto refused = [this](const std::string& name) {
    const Outcome o = extremal({"init", name});
    EXPECT_EQ(o.exit, 2);
    const std::string start =
        "error: extremal init: there is no system '" + name + "' among those that 'extremal list' names";
    EXPECT_EQ(o.error.substr(0, start.size()), start);
    return o.error.substr(std::min(start.size(), o.error.size()));
  };
  EXPECT_EQ(refused("keppler"), "; did you mean 'kepler'?\n");
  EXPECT_EQ(refused("something-else-entirely"), "\n");
  const std::string exact = refused("halo-family"), near = refused("halo-famly");
  EXPECT_NE(exact.find("halo-family.toml', whose system is 'cr3bp'"), std::string::npos) << exact;
  EXPECT_EQ(near.find("; did you mean the scene '"), 0U) << near;
  EXPECT_NE(near.find("halo-family.toml'?"), std::string::npos) << near;
}

}  // namespace
