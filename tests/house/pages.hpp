#pragma once

#include <gtest/gtest.h>

#include "house/sources.hpp"

/// \file The pages of the repository: their code blocks, sections and tables.

namespace house {

struct Block {
  std::string language, text;
};

/// The fenced blocks of a page.
inline std::vector<Block> blocks(const fs::path& page) {
  std::vector<Block> result;
  bool inside = false;
  for (const std::string& line : lines(page)) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) result.push_back({line.substr(3), ""});
    } else if (inside) {
      result.back().text += line + "\n";
    }
  }
  EXPECT_FALSE(inside) << "a block of " << page << " does not end";
  return result;
}

/// The lines below a heading such as "## Keys" up to the next heading of any level.
inline std::vector<std::string> section(const fs::path& page, const std::string& heading) {
  std::vector<std::string> result;
  bool inside = false, code = false;
  for (const std::string& line : lines(page)) {
    code ^= line.starts_with("```");
    if (line.starts_with("#") && !code) {
      inside = line == heading;
    } else if (inside) {
      result.push_back(line);
    }
  }
  EXPECT_FALSE(result.empty()) << page << " has no section " << heading;
  return result;
}

/// The first cells of a section's tables, where they are code: `name`.
inline std::vector<std::string> named_rows(const fs::path& page, const std::string& heading) {
  std::vector<std::string> names;
  for (const std::string& line : section(page, heading))
    if (line.starts_with("| `")) names.push_back(line.substr(3, line.find('`', 3) - 3));
  return names;
}

}  // namespace house
