#include <cstdlib>

#include "files.hpp"
#include "scene/systems.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

const std::string spring =
    "[about]\nwhat = \"\"\"\nA spring.\nMore.\"\"\"\n"
    "[system]\ncoordinates = [\"x\"]\nparameters = { k = 1, m = 2 }\n"
    "definitions = { kinetic = \"m*x'^2/2\", potential = \"k*x^2/2\" }\n"
    "lagrangian = \"kinetic - potential\"\n";

class SystemFiles : public SceneFiles {
 protected:
  void TearDown() override {
    ::unsetenv("EXTREMAL_PROBLEMS");
    SceneFiles::TearDown();
  }
  std::string scene(const std::string& system) {
    return "[system]\n" + system + "\n[boundary]\nduration = 1\n";
  }
};

}  // namespace

TEST_F(SystemFiles, BesideTheSceneWithOrWithoutSuffix) {
  write("spring.toml", spring);
  for (const std::string use : {"spring", "spring.toml"}) {
    const Scene s = read_scene(write("scene.toml", scene("use = \"" + use + "\"")));
    EXPECT_EQ(s.system.lagrangian->value, "kinetic - potential");
    EXPECT_EQ(s.system.coordinates.size(), 1u);
  }
}

TEST_F(SystemFiles, SceneAddsAndReplaces) {
  write("spring.toml", spring);
  const Scene s =
      read_scene(write("scene.toml", scene("use = \"spring\"\nparameters = { k = 9, b = [1, 2] }\n"
                                           "definitions = { potential = \"k*x^4\", extra = \"b[1]\" }\n"
                                           "lagrangian = \"kinetic + extra\"")));
  ASSERT_EQ(s.system.parameters.size(), 3u);
  EXPECT_EQ(std::get<double>(s.system.parameters[0].values[0].value), 9.0);
  EXPECT_EQ(std::get<double>(s.system.parameters[1].values[0].value), 2.0);
  EXPECT_TRUE(s.system.parameters[2].list);
  ASSERT_EQ(s.system.definitions.size(), 3u);
  EXPECT_EQ(s.system.definitions[1].formula.value, "k*x^4");
  EXPECT_EQ(s.system.lagrangian->value, "kinetic + extra");
}

TEST_F(SystemFiles, FoldersOfTheEnvironmentComeAfterTheScene) {
  write("one/spring.toml", spring);
  std::string other = spring;
  write("two/systems/coil.toml", other.replace(other.find("k = 1"), 5, "k = 7"));
  ::setenv("EXTREMAL_PROBLEMS", (":" + (folder / "one").string() + ":" + (folder / "two").string()).c_str(),
           1);
  EXPECT_EQ(message(scene("use = \"spring\"")), "");
  const Scene coil = read_scene(write("scene.toml", scene("use = \"coil\"")));
  EXPECT_EQ(std::get<double>(coil.system.parameters[0].values[0].value), 7.0);
  write("coil.toml", spring);
  const Scene beside = read_scene((folder / "scene.toml").string());
  EXPECT_EQ(std::get<double>(beside.system.parameters[0].values[0].value), 1.0);
}

TEST_F(SystemFiles, SceneMayHaveTheNameOfItsSystem) {
  write("systems/spring.toml", spring);
  ::setenv("EXTREMAL_PROBLEMS", folder.c_str(), 1);
  EXPECT_EQ(message_of(write("spring.toml", scene("use = \"spring\""))), "");
}

TEST_F(SystemFiles, UnknownSystem) {
  write("systems/spring.toml", spring);
  ::setenv("EXTREMAL_PROBLEMS", folder.c_str(), 1);
  try {
    read_scene(write("scene.toml", scene("use = \"sprnig\"")));
    FAIL();
  } catch (const UnknownName& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("scene.toml:2:8: no system file 'sprnig' beside the scene or among: "),
              std::string::npos)
        << what;
    EXPECT_NE(what.find("spring"), std::string::npos);
    EXPECT_NE(std::find(e.known.begin(), e.known.end(), "spring"), e.known.end());
  }
}

TEST_F(SystemFiles, ErrorsPointIntoTheFile) {
  write("bad.toml", "[about]\nwhat = \"x\"\n[system]\ncordinates = [\"x\"]\n");
  EXPECT_EQ(message(scene("use = \"bad\"")), "bad.toml:4:1: unknown key 'cordinates' in [system]");
  write("bad.toml", "[about]\nwhat = \"x\"\n");
  EXPECT_EQ(message(scene("use = \"bad\"")), "bad.toml:1:1: a system file needs the table [system]");
  write("bad.toml", "[system]\nuse = \"spring\"\n");
  EXPECT_EQ(message(scene("use = \"bad\"")), "bad.toml:2:7: a system file cannot use another");
  write("bad.toml", "[solve]\n");
  EXPECT_EQ(message(scene("use = \"bad\"")), "bad.toml:1:2: unknown key 'solve'");
}

TEST_F(SystemFiles, ListGivesTheFirstLineOfAbout) {
  write("systems/aaa_spring.toml", spring);
  write("systems/broken.toml", "[system");
  ::setenv("EXTREMAL_PROBLEMS", folder.c_str(), 1);
  const auto files = system_files();
  ASSERT_FALSE(files.empty());
  EXPECT_EQ(files[0].name, "aaa_spring");
  EXPECT_EQ(files[0].about, "A spring.");
  for (const auto& f : files) EXPECT_NE(f.name, "broken");
}
