#include <gtest/gtest.h>

#include "house/sources.hpp"

/// What README shows is what the repository holds. Its commands are run by .ci/run.

using namespace house;

namespace {

struct Block {
  std::string language, text;
};

std::vector<Block> blocks() {
  std::vector<Block> result;
  bool inside = false;
  for (const std::string& line : lines(root() / "README.md")) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) result.push_back({line.substr(3), ""});
    } else if (inside) {
      result.back().text += line + "\n";
    }
  }
  EXPECT_FALSE(inside) << "a block of README.md does not end";
  return result;
}

TEST(Readme, ScenesAreFiles) {
  std::set<std::string> scenes;
  for (const auto& entry : fs::directory_iterator(root() / "problems/scenes"))
    scenes.insert(read(entry.path()));
  int shown = 0;
  for (const Block& block : blocks()) {
    if (block.language != "toml") continue;
    ++shown;
    EXPECT_TRUE(scenes.contains(block.text)) << "no file of problems/scenes holds\n" << block.text;
  }
  EXPECT_GT(shown, 0);
}

TEST(Readme, CodeIsTheConsumer) {
  const std::string consumer = read(root() / "tests/consumer/main.cpp");
  const std::string lists = read(root() / "tests/consumer/CMakeLists.txt");
  int shown = 0;
  for (const Block& block : blocks()) {
    if (block.language != "cpp" && block.language != "cmake") continue;
    ++shown;
    const std::string& source = block.language == "cpp" ? consumer : lists;
    EXPECT_NE(source.find(block.text), std::string::npos) << "tests/consumer does not hold\n" << block.text;
  }
  EXPECT_EQ(shown, 2);
}

TEST(Readme, LinksLead) {
  const std::string text = std::regex_replace(read(root() / "README.md"), std::regex("```[^`]*```"), "");
  const std::regex link(R"(\]\(([^)#]+)\))");
  for (std::sregex_iterator match(text.begin(), text.end(), link), none; match != none; ++match) {
    const std::string target = (*match)[1];
    EXPECT_TRUE(target.starts_with("http") || fs::exists(root() / target)) << target;
  }
}

}  // namespace
