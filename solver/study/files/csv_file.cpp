#include "study/files/csv_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace extremal {
namespace {

using SourcePointer = std::shared_ptr<const Source>;

/// In front of what spreadsheets save as UTF-8.
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

std::string_view trimmed(std::string_view s) {
  const auto begin = s.find_first_not_of(" \t\r\"");
  if (begin == std::string_view::npos) return {};
  return s.substr(begin, s.find_last_not_of(" \t\r\"") - begin + 1);
}

std::vector<CsvCell> cells_of(std::string_view line, const SourcePointer& source, int number) {
  std::vector<CsvCell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(
        {trimmed(line.substr(begin, end - begin)), {source, number, static_cast<int>(begin) + 1}});
    begin = end + 1;
  }
  return cells;
}

}  // namespace

double number_in(const CsvCell& cell) {
  double value = 0;
  const char* end = cell.text.data() + cell.text.size();
  const auto [stop, error] = std::from_chars(cell.text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value))
    throw SceneError(cell.at, fmt::format("'{}' is not a finite number", cell.text));
  return value;
}

SceneError missing_column(const CsvFile& file, std::string_view name) {
  constexpr std::size_t most_listed = 12;
  std::vector<std::string_view> names;
  for (const CsvCell& cell : file.header) names.push_back(cell.text);
  if (names.size() > most_listed) names[most_listed] = "…";
  names.resize(std::min(names.size(), most_listed + 1));
  return {file.header.front().at,
          fmt::format("the file has no column '{}'; it has {}{}", name, fmt::join(names, ", "),
                      names.size() == 1 ? " alone: commas separate columns" : "")};
}

CsvFile read_csv(const SourcePointer& source) {
  CsvFile file;
  std::string_view rest = source->text;
  if (rest.starts_with(byte_order_mark)) rest.remove_prefix(byte_order_mark.size());
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    std::vector<CsvCell> cells = cells_of(line, source, number);
    if (file.header.empty()) {
      file.header = std::move(cells);
      continue;
    }
    if (cells.size() != file.header.size())
      throw SceneError({source, number, 1},
                       fmt::format("found {} values for {} columns", cells.size(), file.header.size()));
    file.rows.push_back(std::move(cells));
  }
  return file;
}

}  // namespace extremal
