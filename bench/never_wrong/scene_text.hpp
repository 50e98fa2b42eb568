#pragma once

#include <string>
#include <utility>
#include <vector>

/// \file Pieces of a scene's text.

namespace bench {

/// Keys and what is assigned to them, each as it is written.
using Entries = std::vector<std::pair<std::string, std::string>>;

/// So that it reads back as the same double.
std::string number_text(double x);
std::string quoted(const std::string& text);
/// { "x" = 1, … }
std::string inline_table(const Entries& entries);
/// [header] and a line for each entry; nothing without entries.
std::string table_text(const std::string& header, const Entries& entries);

}  // namespace bench
