#include <fmt/format.h>

#include "app/command.hpp"
#include "house/pages.hpp"

/// What the pages show is what the repository holds. Their commands are run by .ci/run.

using namespace house;

namespace {

const fs::path readme = root() / "README.md";

TEST(Readme, ScenesAreFiles) {
  std::set<std::string> scenes;
  for (const auto& entry : fs::directory_iterator(root() / "problems/scenes"))
    scenes.insert(read(entry.path()));
  int shown = 0;
  for (const Block& block : blocks(readme)) {
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
  for (const Block& block : blocks(readme)) {
    if (block.language != "cpp" && block.language != "cmake") continue;
    ++shown;
    const std::string& source = block.language == "cpp" ? consumer : lists;
    EXPECT_NE(source.find(block.text), std::string::npos) << "tests/consumer does not hold\n" << block.text;
  }
  EXPECT_EQ(shown, 2);
}

/// Errors and times are left out: the last digits of the former differ between processors.
std::string without_small_numbers(const std::string& text) {
  const std::string masked = std::regex_replace(text, std::regex(R"(\d\.\de-\d\d)"), "…");
  return masked.substr(0, masked.find("time  "));
}

using Shown = extremal::test::Command;
TEST_F(Shown, ResultIsThatOfTheScene) {
  const auto outcome = extremal({"solve", (root() / "problems/scenes/kepler.toml").string()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  int shown = 0;
  for (const Block& block : blocks(readme)) {
    if (block.language != "text") continue;
    ++shown;
    EXPECT_EQ(without_small_numbers(block.text), without_small_numbers(outcome.out));
  }
  EXPECT_EQ(shown, 1);
}

/// Interactive pages of scenes are made by `make gallery` and not kept.
bool is_page_of_scene(const std::string& target) {
  const fs::path path = target;
  return path.parent_path() == "pages" && path.extension() == ".html" &&
         fs::exists(root() / "problems/scenes" / path.filename().replace_extension(".toml"));
}

std::string prose(const fs::path& page) {
  return std::regex_replace(read(page), std::regex("```[^`]*```|`[^`]*`"), "");
}

/// Pages of single rooms, as the names of their files in solver/.
std::vector<std::string> pages_of_rooms() {
  std::vector<std::string> pages;
  for (const auto& entry : fs::recursive_directory_iterator(root() / "solver"))
    if (entry.path().filename() == "README.md" && entry.path().parent_path() != root() / "solver")
      pages.push_back(fs::relative(entry.path(), root() / "solver").generic_string());
  return pages;
}

TEST(Pages, LinksExist) {
  std::vector<std::string> names = {"README.md",           "problems/README.md", "problems/gallery.md",
                                    "solver/README.md",    "bench/README.md",    "bench/data/README.md",
                                    "tests/data/README.md"};
  for (const std::string& page : pages_of_rooms()) names.push_back("solver/" + page);
  for (const std::string& name : names) {
    const fs::path page = root() / name;
    const std::string text = prose(page);
    const std::regex link(R"~(\]\(([^)#]+)[)#]|src="([^"]+)")~");
    for (std::sregex_iterator match(text.begin(), text.end(), link), none; match != none; ++match) {
      const std::string target = (*match)[1].matched ? (*match)[1] : (*match)[2];
      const bool made = name == "problems/gallery.md" && is_page_of_scene(target);
      EXPECT_TRUE(made || target.starts_with("http") || fs::exists(page.parent_path() / target))
          << name << " links " << target;
    }
  }
}

TEST(Pages, TheMethodLinksThoseOfRooms) {
  const std::vector<std::string> pages = pages_of_rooms();
  ASSERT_GT(pages.size(), 10u);
  const std::string method = prose(root() / "solver/README.md");
  for (const std::string& page : pages)
    EXPECT_NE(method.find("](" + page + ")"), std::string::npos) << "solver/README.md does not link " << page;
}

/// `make gallery` draws the pictures; a repository has room for small ones.
TEST(Gallery, ShowsEveryScene) {
  const std::string gallery = read(root() / "problems/gallery.md");
  std::uintmax_t size = 0, count = 0;
  for (const auto& entry : fs::directory_iterator(root() / "problems/scenes")) {
    const std::string name = entry.path().stem();
    const fs::path picture = root() / "problems/pictures" / (name + ".svg");
    std::smatch title;
    const std::string scene = read(entry.path());
    ASSERT_TRUE(std::regex_search(scene, title, std::regex("^title = \"(.*)\"\n"))) << name;
    for (const std::string& part : {fmt::format("[{}](scenes/{}.toml)", title[1].str(), name),
                                    fmt::format("src=\"pictures/{}.svg\"", name),
                                    fmt::format("[Interactive page](pages/{}.html)", name)})
      EXPECT_NE(gallery.find(part), std::string::npos) << part;
    ASSERT_TRUE(fs::exists(picture)) << picture << ": make gallery draws it";
    size += fs::file_size(picture);
    ++count;
  }
  ASSERT_GT(count, 0u);
  EXPECT_LE(size / count, 60'000u) << "bytes of a picture";
}

}  // namespace
