#include "scene_text.hpp"

#include <fmt/format.h>

namespace bench {

std::string number_text(double x) { return fmt::format("{}", x); }

std::string quoted(const std::string& text) { return '"' + text + '"'; }

std::string inline_table(const Entries& entries) {
  std::string text = "{ ";
  for (const auto& [key, value] : entries) {
    if (text.size() > 2) text += ", ";
    text += key + " = " + value;
  }
  return text + " }";
}

std::string table_text(const std::string& header, const Entries& entries) {
  if (entries.empty()) return {};
  std::string text = fmt::format("\n[{}]\n", header);
  for (const auto& [key, value] : entries) text += key + " = " + value + '\n';
  return text;
}

}  // namespace bench
