#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

#include "house/sources.hpp"
#include "machine/long_test.hpp"

/// Kernels are compiled for several instruction sets. Any inline function that they share with other files
/// could be kept by the linker in the copy that this processor cannot run.

using namespace house;

namespace {

/// What a file includes, its headers' includes too.
void collect(const fs::path& file, std::set<fs::path>& project, std::set<std::string>& foreign) {
  for (const Include& include : includes(file)) {
    const fs::path path = root() / "solver" / include.file;
    if (!include.quoted)
      foreign.insert(include.file);
    else if (project.insert(path).second)
      collect(path, project, foreign);
  }
}

TEST(Kernels, IncludeNoEigenAndNoStandardTemplates) {
  const std::set<std::string> harmless = {"cstddef",     "cstdint",    "stddef.h", "stdint.h",
                                          "immintrin.h", "arm_neon.h", "sleef.h"};
  int kernels = 0;
  for (const fs::path& file : sources("solver")) {
    if (!is_kernel(file)) continue;
    ++kernels;
    std::set<fs::path> project;
    std::set<std::string> foreign;
    collect(file, project, foreign);
    for (const std::string& include : foreign)
      EXPECT_TRUE(harmless.contains(include)) << file << " includes <" << include << ">";
  }
  EXPECT_GT(kernels, 0);
}

std::vector<std::string> output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::vector<std::string> result;
  std::array<char, 4096> line;
  while (pipe && std::fgets(line.data(), line.size(), pipe.get())) result.emplace_back(line.data());
  return result;
}

/// In the object files themselves: every symbol that a kernel defines for the linker names its level.
TEST(Kernels, DefineSymbolsOfTheirLevelOnly) {
  LONG_TEST();
  const std::regex defined(R"((\S+\.simd\.cpp\.o):\S* ([TWVuDBR]) (\S+))");
  const std::regex levelled("^_Z[A-Z]*N?K?8extremal(4base|2v3|2v4)");
  int symbols = 0;
  for (const std::string& line :
       output_of("nm -A --defined-only " EXTREMAL_BINARY_DIR "/solver/libextremal_*.a 2>&1")) {
    std::smatch match;
    if (!std::regex_search(line, match, defined)) continue;
    const std::string symbol = match[3];
    if (symbol.starts_with("__odr_asan")) continue;
    ++symbols;
    EXPECT_TRUE(std::regex_search(symbol, levelled)) << match[1] << " defines " << symbol;
  }
  EXPECT_GT(symbols, 0) << "nm found no kernels below " EXTREMAL_BINARY_DIR;
}

}  // namespace
