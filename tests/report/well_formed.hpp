#pragma once

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

/// \file As much of an XML parser as shows that a picture can be read.

namespace extremal {

/// Text between tags: no "]]>", and '&' only where it begins one of the predefined entities.
inline bool clean(std::string_view text) {
  if (text.find("]]>") != text.npos) return false;
  for (std::size_t k = text.find('&'); k != text.npos; k = text.find('&', k + 1)) {
    const auto begins = [&](const char* entity) { return text.substr(k).starts_with(entity); };
    if (!begins("&amp;") && !begins("&lt;") && !begins("&gt;") && !begins("&quot;")) return false;
  }
  return true;
}

/// Where the tag that begins at `start` ends; quoted attributes may hold '>' but no '<'.
inline std::size_t end_of_tag(std::string_view xml, std::size_t start) {
  char quote = 0;
  for (std::size_t k = start + 1; k < xml.size(); ++k) {
    if (xml[k] == '<') return xml.npos;
    if (quote != 0) {
      if (xml[k] == quote) quote = 0;
    } else if (xml[k] == '"' || xml[k] == '\'') {
      quote = xml[k];
    } else if (xml[k] == '>') {
      return k;
    }
  }
  return xml.npos;
}

/// Whether tags are complete and nest, and text holds no markup.
inline testing::AssertionResult well_formed(std::string_view xml) {
  std::vector<std::string_view> open;
  std::size_t position = 0;
  for (std::size_t start = xml.find('<'); start != xml.npos; start = xml.find('<', position)) {
    if (!clean(xml.substr(position, start - position)))
      return testing::AssertionFailure() << "markup in text";
    const std::size_t end = end_of_tag(xml, start);
    if (end == xml.npos) return testing::AssertionFailure() << "a tag is not complete";
    position = end + 1;
    const std::string_view tag = xml.substr(start + 1, end - start - 1);
    if (tag.starts_with('?') || tag.ends_with('/')) continue;
    if (!tag.starts_with('/')) {
      open.push_back(tag.substr(0, tag.find_first_of(" \t\n")));
    } else if (open.empty() || open.back() != tag.substr(1)) {
      return testing::AssertionFailure() << "<" << tag << "> closes nothing";
    } else {
      open.pop_back();
    }
  }
  if (!clean(xml.substr(position))) return testing::AssertionFailure() << "markup in text";
  if (!open.empty()) return testing::AssertionFailure() << "<" << open.back() << "> is not closed";
  return testing::AssertionSuccess();
}

}  // namespace extremal
