#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "study/guess.hpp"

namespace extremal {
namespace {

using Json = nlohmann::json;
using SourcePointer = std::shared_ptr<const Source>;

std::string_view trimmed(std::string_view s) {
  const auto begin = s.find_first_not_of(" \t\r\"");
  if (begin == std::string_view::npos) return {};
  return s.substr(begin, s.find_last_not_of(" \t\r\"") - begin + 1);
}

/// A cell of a CSV and where it stands.
struct Cell {
  std::string_view text;
  Location at;
};

std::vector<Cell> cells_of(std::string_view line, const SourcePointer& source, int number) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(
        {trimmed(line.substr(begin, end - begin)), {source, number, static_cast<int>(begin) + 1}});
    begin = end + 1;
  }
  return cells;
}

double number_in(const Cell& cell) {
  double value = 0;
  const char* end = cell.text.data() + cell.text.size();
  const auto [stop, error] = std::from_chars(cell.text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value))
    throw SceneError(cell.at, fmt::format("'{}' is not a finite number", cell.text));
  return value;
}

/// Of each name the column that has it.
std::vector<std::size_t> columns_of(const std::vector<Cell>& header, const std::vector<std::string>& names) {
  std::vector<std::size_t> columns;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(header.begin(), header.end(), [&](const Cell& c) { return c.text == name; });
    if (found == header.end())
      throw SceneError(header.front().at, fmt::format("the file has no column '{}'", name));
    columns.push_back(found - header.begin());
  }
  return columns;
}

SampledFile read_csv(const SourcePointer& source, const std::vector<std::string>& names) {
  SampledFile samples;
  std::vector<std::size_t> columns;
  std::size_t width = 0;
  std::string_view rest = source->text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::vector<Cell> cells = cells_of(line, source, number);
    if (columns.empty()) {
      columns = columns_of(cells, names);
      width = cells.size();
      continue;
    }
    if (cells.size() != width)
      throw SceneError({source, number, 1},
                       fmt::format("found {} values for {} columns", cells.size(), width));
    samples.t.push_back(number_in(cells[columns[0]]));
    for (std::size_t a = 1; a < columns.size(); ++a) samples.q.push_back(number_in(cells[columns[a]]));
  }
  return samples;
}

SampledFile read_json(const SourcePointer& source, const std::vector<std::string>& names) {
  const Location whole{source, 0, 0};
  const Json root = Json::parse(source->text, nullptr, false);
  if (root.is_discarded()) throw SceneError(whole, "this is not JSON");
  const auto found = root.is_object() ? root.find("samples") : root.end();
  if (!root.is_object() || found == root.end() || !found->is_object())
    throw SceneError(whole, "this result has no samples; solve with --samples to write some");
  std::vector<std::vector<double>> columns;
  for (const std::string& name : names) {
    const auto column = found->find(name);
    if (column == found->end()) throw SceneError(whole, fmt::format("the samples have no '{}'", name));
    const bool numbers = column->is_array() && std::all_of(column->begin(), column->end(), [](const Json& x) {
                           return x.is_number() && std::isfinite(x.get<double>());
                         });
    if (!numbers)
      throw SceneError(whole, fmt::format("'{}' of the samples is not a list of finite numbers", name));
    columns.push_back(column->get<std::vector<double>>());
    if (columns.back().size() != columns.front().size())
      throw SceneError(whole, fmt::format("the samples have {} times and {} values of '{}'",
                                          columns.front().size(), columns.back().size(), name));
  }
  SampledFile samples;
  samples.t = columns.front();
  for (std::size_t k = 0; k < samples.t.size(); ++k)
    for (std::size_t a = 1; a < columns.size(); ++a) samples.q.push_back(columns[a][k]);
  return samples;
}

}  // namespace

SampledFile read_samples(const std::string& path, const std::vector<std::string>& names) {
  const SourcePointer source = read_source(path);
  std::vector<std::string> wanted{"t"};
  wanted.insert(wanted.end(), names.begin(), names.end());
  const std::size_t first = source->text.find_first_not_of(" \t\r\n");
  const bool json = first != std::string::npos && (source->text[first] == '{' || source->text[first] == '[');
  const SampledFile samples = json ? read_json(source, wanted) : read_csv(source, wanted);
  const Location whole{source, 0, 0};
  if (samples.t.size() < 2)
    throw SceneError(whole, fmt::format("found {} samples; need at least 2", samples.t.size()));
  for (std::size_t k = 1; k < samples.t.size(); ++k)
    if (!(samples.t[k] > samples.t[k - 1]))
      throw SceneError(
          whole, fmt::format("the times must increase; found {} after {}", samples.t[k], samples.t[k - 1]));
  return samples;
}

}  // namespace extremal
