#include <fmt/format.h>
#include <gtest/gtest.h>

#include "house/sources.hpp"

using namespace house;

namespace {

std::string place_of(const fs::path& file) {
  return fs::relative(file, root() / "solver").parent_path().generic_string();
}

TEST(Layers, NameEveryFolderAndOnlyEarlierOnes) {
  const Layers layers = house::layers();
  ASSERT_GE(layers.order.size(), 10u);
  std::set<std::string> earlier;
  for (const std::string& folder : layers.order) {
    for (const std::string& other : layers.allowed.at(folder))
      EXPECT_TRUE(earlier.contains(other))
          << folder << " may include " << other << ", which does not precede it";
    EXPECT_TRUE(earlier.insert(folder).second) << folder << " stands twice";
  }
  for (const auto& entry : fs::recursive_directory_iterator(root() / "solver")) {
    if (!entry.is_directory()) continue;
    const std::string place = fs::relative(entry.path(), root() / "solver").generic_string();
    EXPECT_TRUE(earlier.contains(place)) << place << " is not in layers.txt";
  }
  for (const std::string& place : layers.order)
    EXPECT_TRUE(fs::is_directory(root() / "solver" / place)) << place << " is no folder of solver/";
}

TEST(Layers, EveryIncludeOfSolverIsAllowed) {
  const Layers layers = house::layers();
  const std::vector<fs::path> files = sources("solver");
  ASSERT_GT(files.size(), 20u);
  for (const fs::path& file : files) {
    const std::string place = place_of(file);
    ASSERT_TRUE(layers.allowed.contains(place)) << file;
    for (const Include& include : includes(file)) {
      if (!include.quoted) continue;
      EXPECT_TRUE(fs::exists(root() / "solver" / include.file))
          << file << ":" << include.line << ": " << include.file << " is no file of solver/";
      const std::string other = fs::path(include.file).parent_path().generic_string();
      EXPECT_TRUE(layers.allow(place, other))
          << file << ":" << include.line << ": " << place << " may not include " << other;
    }
  }
}

TEST(Layers, SolverReachesNothingBesideIt) {
  for (const fs::path& file : sources("solver"))
    for (const Include& include : includes(file))
      for (const char* beside : {"problems/", "tests/", "bench/", "..", "extremal/", "gtest", "benchmark"})
        EXPECT_FALSE(include.file.starts_with(beside)) << file << ":" << include.line << ": " << include.file;
}

TEST(Layers, ThePageOfSolverNamesEveryFolder) {
  const std::string page = read(root() / "solver/README.md");
  for (const std::string& folder : house::layers().order)
    EXPECT_NE(page.find(fmt::format("| [{}](", folder)), std::string::npos) << folder;
}

}  // namespace
