#include <nlohmann/json.hpp>

#include "command.hpp"
#include "report/page.hpp"

using namespace extremal::test;

namespace {

/// Commands that make pages, in a build that can.
class View : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    try {
      extremal::require_pages();
    } catch (const std::invalid_argument& e) {
      const Outcome o = extremal({"view", "r.json"});
      EXPECT_EQ(o.exit, 2);
      GTEST_SKIP() << e.what();
    }
    write("scene.toml", scene);
  }

  static constexpr const char* scene =
      "title = 'Transfer'\n[system]\nuse = 'kepler'\n[boundary]\nstart = { x = 1.0, y = 0.0 }\n"
      "end = { x = -0.6, y = 0.9 }\nduration = 2.5\n";
};

TEST_F(View, EachVerbWritesAPage) {
  for (const char* verb : {"solve", "compare", "spectrum"}) {
    const Outcome o = extremal({verb, "scene.toml", "--quiet", "--plot", "p.html"});
    ASSERT_EQ(o.exit, 0) << verb << o.error;
    EXPECT_TRUE(read_text(folder / "p.html").starts_with("<!doctype html>")) << verb;
    fs::remove(folder / "p.html");
  }
  write("family.toml", std::string(scene) + "[continuation]\nparameter = 'duration'\nto = 2.7\npoints = 3\n");
  const Outcome o =
      extremal({"continue", "family.toml", "--quiet", "--plot", "p.html", "--output", "b.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_NE(read_text(folder / "p.html").find("\"kind\":\"branch\""), std::string::npos);
  EXPECT_EQ(extremal({"view", "b.json"}).out, "b.html\n");
  EXPECT_TRUE(fs::exists(folder / "b.html"));
}

TEST_F(View, OfASavedBranchHasTheOrbitsThatWereSaved) {
  write("family.toml", std::string(scene) + "[continuation]\nparameter = 'duration'\nto = 2.7\npoints = 3\n");
  const auto page_of = [&](const std::vector<std::string>& samples) {
    std::vector<std::string> words{"continue", "family.toml", "--quiet", "--output", "b.json"};
    words.insert(words.end(), samples.begin(), samples.end());
    const Outcome o = extremal(words);
    EXPECT_EQ(o.exit, 0) << o.error;
    EXPECT_EQ(extremal({"view", "b.json"}).exit, 0);
    return read_text(folder / "b.html");
  };
  EXPECT_NE(page_of({}).find("\"picture\":null"), std::string::npos);
  const std::string page = page_of({"--samples", "40"});
  EXPECT_EQ(page.find("\"picture\":null"), std::string::npos);
  EXPECT_EQ(page.find("\"samples\":"), std::string::npos);
  const auto points = nlohmann::json::parse(read_text(folder / "b.json"))["points"];
  ASSERT_EQ(points.size(), 3U);
  for (const auto& point : points) {
    const auto& samples = point["samples"];
    EXPECT_EQ(samples["t"].size(), 40U);
    EXPECT_EQ(samples["x"][0], point["start"]["x"]);
    EXPECT_EQ(samples["x'"][0], point["start"]["x'"]);
    EXPECT_NEAR(samples["y"][39].get<double>(), 0.9, 1e-12);
    EXPECT_EQ(samples["t"][39], point["duration"]);
  }
  EXPECT_EQ(extremal({"continue", "family.toml", "--samples", "40"}).exit, 2);
}

TEST_F(View, ASavedResultGetsAPageThatIsNamed) {
  ASSERT_EQ(extremal({"solve", "scene.toml", "--samples", "50", "--output", "out/r.json"}).exit, 0);
  const Outcome o = extremal({"view", "out/r.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.out, "out/r.html\n");
  EXPECT_TRUE(read_text(folder / "out/r.html").starts_with("<!doctype html>"));
  EXPECT_EQ(extremal({"view", "out/r.json", "--output", "else.html"}).out, "else.html\n");
  EXPECT_TRUE(extremal({"view", "out/r.json", "--output", "-"}).out.starts_with("<!doctype html>"));
}

TEST_F(View, OfASavedResultIsThePageOfThePlot) {
  write("moving.toml",
        "[system]\ncoordinates = ['x', 'y']\nlagrangian = \"(x'^2 + y'^2)/2\"\n[boundary]\n"
        "start = { x = -1.0, y = 0.05 }\nend = { x = 1.0, y = 0.05 }\nduration = 1.0\n"
        "[path]\nconstraints = ['x^2 + (y + 0.1*t)^2 >= 0.09']\n");
  std::vector<std::string> scenes{"moving.toml"};
  for (const char* name : {"cr3bp", "kepler-tour", "pendulum-solutions", "pendulum-walls", "round-a-disc",
                           "brachistochrone", "slider-crank", "damped-pendulum-fit"})
    scenes.push_back(fmt::format("{}/problems/scenes/{}.toml", EXTREMAL_SOURCE_DIR, name));
  for (const std::string& name : scenes) {
    const Outcome o =
        extremal({"solve", name, "--samples", "1000", "--output", "r.json", "--plot", "p.html"});
    if (o.error.find("not part of this build") != std::string::npos) continue;
    ASSERT_EQ(o.exit, 0) << name << o.error;
    ASSERT_EQ(extremal({"view", "r.json"}).exit, 0) << name;
    EXPECT_TRUE(read_text(folder / "r.html") == read_text(folder / "p.html")) << name;
  }
}

TEST_F(View, BoundariesAndImpulsesAreInThePage) {
  const auto page = [&](const std::string& name) {
    const std::string path = fmt::format("{}/problems/scenes/{}.toml", EXTREMAL_SOURCE_DIR, name);
    const Outcome o = extremal({"solve", path, "--plot", "p.html"});
    EXPECT_EQ(o.exit, 0) << o.error;
    return read_text(folder / "p.html");
  };
  const std::string walls = page("pendulum-walls");
  EXPECT_NE(walls.find("\"walls\":[{\"x\":["), std::string::npos);
  EXPECT_NE(walls.find("\"contacts\":[{\"constraint\":"), std::string::npos);
  const std::string disc = page("round-a-disc");
  EXPECT_NE(disc.find("\"obstacles\":[{\"x\":["), std::string::npos);
  EXPECT_EQ(disc.find("\"walls\":"), std::string::npos);
  EXPECT_NE(page("kepler-tour").find("\"waypoints\":[{\"t\":"), std::string::npos);
}

TEST_F(View, WhatCannotBeShownIsRefusedWithWhatToDo) {
  ASSERT_EQ(extremal({"solve", "scene.toml", "--output", "r.json"}).exit, 0);
  const Outcome without = extremal({"view", "r.json"});
  EXPECT_EQ(without.exit, 2);
  EXPECT_NE(without.error.find("--samples 1000 --output r.json"), std::string::npos) << without.error;
  EXPECT_FALSE(fs::exists(folder / "r.html"));
  EXPECT_EQ(extremal({"view", "none.json"}).exit, 2);
  EXPECT_EQ(extremal({"view", "scene.toml"}).exit, 2);
  EXPECT_EQ(extremal({"view"}).exit, 2);
  EXPECT_EQ(extremal({"view", "r.json", "--output", "r.json"}).exit, 2);
  // What the message says to do works.
  ASSERT_EQ(extremal({"solve", "scene.toml", "--samples", "1000", "--output", "r.json"}).exit, 0);
  EXPECT_EQ(extremal({"view", "r.json"}).exit, 0);
}

}  // namespace
