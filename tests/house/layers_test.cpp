#include <fmt/format.h>
#include <gtest/gtest.h>

#include "house/sources.hpp"

using namespace house;

namespace {

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
  for (const auto& entry : fs::directory_iterator(root() / "solver")) {
    if (!entry.is_directory()) continue;
    EXPECT_TRUE(earlier.contains(entry.path().filename())) << entry.path() << " is not in layers.txt";
  }
}

TEST(Layers, EveryIncludeOfSolverIsAllowed) {
  const Layers layers = house::layers();
  const std::vector<fs::path> files = sources("solver");
  ASSERT_GT(files.size(), 20u);
  for (const fs::path& file : files) {
    const std::string folder = *fs::relative(file, root() / "solver").begin();
    for (const Include& include : includes(file)) {
      if (!include.quoted) continue;
      const std::string other = *fs::path(include.file).begin();
      EXPECT_TRUE(fs::exists(root() / "solver" / include.file))
          << file << ":" << include.line << ": " << include.file << " is no file of solver/";
      EXPECT_TRUE(other == folder || layers.allowed.at(folder).contains(other))
          << file << ":" << include.line << ": " << folder << " may not include " << other;
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
