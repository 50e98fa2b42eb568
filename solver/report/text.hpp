#pragma once

#include <string>
#include <vector>

#include "report/result.hpp"

/// \file Text for people.

namespace extremal {

/// A result in some ten aligned lines, each ended by a newline; below them a table of the solutions of a
/// search that found several.
std::string summary(const Result& result);

/// "850 ns", "12.3 µs", "4.56 ms", "1.23 s": three digits.
std::string duration_text(double seconds);

/// UTF-8 as a terminal may get it, and as JSON may hold it in a string. Control characters, those that turn
/// the direction of writing among them, are written as "\u001b"; line ends stay where `lines`, else they are
/// written as "\n". Bytes that are no UTF-8 become U+FFFD.
std::string visible(const std::string& text, bool lines);

/// Columns of text. Every row has as many cells as the head.
struct Table {
  enum class Align { left, right };
  struct Heading {
    std::string text;
    Align align = Align::right;
  };
  std::vector<Heading> head;
  std::vector<std::vector<std::string>> rows;
};

/// Columns aligned, two spaces between them. Throws std::invalid_argument for a row of another length.
std::string plain_text(const Table& table);

}  // namespace extremal
