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

TEST_F(View, ASavedResultGetsAPageThatIsNamed) {
  ASSERT_EQ(extremal({"solve", "scene.toml", "--samples", "50", "--output", "out/r.json"}).exit, 0);
  const Outcome o = extremal({"view", "out/r.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.out, "out/r.html\n");
  EXPECT_TRUE(read_text(folder / "out/r.html").starts_with("<!doctype html>"));
  EXPECT_EQ(extremal({"view", "out/r.json", "--output", "else.html"}).out, "else.html\n");
  EXPECT_TRUE(extremal({"view", "out/r.json", "--output", "-"}).out.starts_with("<!doctype html>"));
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
