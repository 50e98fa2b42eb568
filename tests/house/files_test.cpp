#include <gtest/gtest.h>

#include "house/sources.hpp"

using namespace house;

namespace {

std::vector<fs::path> all_sources() {
  std::vector<fs::path> result;
  for (const char* folder : {"solver", "tests", "bench"})
    for (const fs::path& file : sources(folder)) result.push_back(file);
  return result;
}

/// Characters, not bytes, of a UTF-8 text.
std::size_t characters(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

TEST(Files, HaveShortCleanLines) {
  for (const fs::path& file : all_sources()) {
    int number = 0;
    for (const std::string& line : lines(file)) {
      ++number;
      EXPECT_LE(characters(line), 110u) << file << ":" << number;
      EXPECT_TRUE(line.empty() || (line.back() != ' ' && line.back() != '\r')) << file << ":" << number;
      EXPECT_EQ(line.find('\t'), std::string::npos) << file << ":" << number;
    }
    EXPECT_TRUE(read(file).ends_with("\n")) << file;
  }
}

TEST(Files, HeadersGuardThemselves) {
  for (const fs::path& file : all_sources()) {
    if (file.extension() != ".hpp") continue;
    EXPECT_TRUE(read(file).starts_with("#pragma once\n")) << file;
  }
}

/// Two types of one name in one namespace would be one to the linker, and to no compiler an error.
TEST(Files, DefineEachTypeOnce) {
  static const std::regex space(R"(^namespace ([\w:]+) \{)"),
      type(R"(^(?:struct|class|enum class) (\w+)(?!\w|<)[^;]*$)");  // specialisations aside
  std::map<std::string, fs::path> seen;
  for (const fs::path& file : sources("solver")) {
    if (file.extension() != ".hpp") continue;
    std::string scope;
    for (const std::string& line : lines(file)) {
      std::smatch match;
      if (std::regex_search(line, match, space)) scope = match[1];
      if (!std::regex_search(line, match, type)) continue;
      const auto [place, first] = seen.emplace(scope + "::" + match[1].str(), file);
      EXPECT_TRUE(first) << file << " and " << place->second << " both define " << place->first;
    }
  }
  EXPECT_GT(seen.size(), 50u);
}

}  // namespace
