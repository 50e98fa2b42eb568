#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "scene/source.hpp"

/// \file Tables of comma separated values.

namespace extremal {

/// A cell without blanks and quotes around it, and where it stands. The text is that of the source.
struct CsvCell {
  std::string_view text;
  Location at;
};

/// Blank lines and lines that begin with # do not count.
struct CsvFile {
  std::vector<CsvCell> header;
  std::vector<std::vector<CsvCell>> rows;  ///< each with as many cells as the header
};

/// Throws SceneError, with the line, where a row has more or fewer cells than the header.
CsvFile read_csv(const std::shared_ptr<const Source>& source);

/// "the file has no column 'x'; it has t, y", at the header, which is not empty.
SceneError missing_column(const CsvFile& file, std::string_view name);

/// Throws SceneError, with line and column, where the cell is not a finite number.
double number_in(const CsvCell& cell);

}  // namespace extremal
