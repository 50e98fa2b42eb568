#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "study/csv_file.hpp"
#include "study/guess.hpp"

namespace extremal {
namespace {

using Json = nlohmann::json;
using SourcePointer = std::shared_ptr<const Source>;

/// Of each name the column that has it.
std::vector<std::size_t> columns_of(const std::vector<CsvCell>& header,
                                    const std::vector<std::string>& names) {
  std::vector<std::size_t> columns;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(header.begin(), header.end(), [&](const CsvCell& c) { return c.text == name; });
    if (found == header.end())
      throw SceneError(header.front().at, fmt::format("the file has no column '{}'", name));
    columns.push_back(found - header.begin());
  }
  return columns;
}

SampledFile read_csv(const SourcePointer& source, const std::vector<std::string>& names) {
  const CsvFile file = read_csv(source);
  SampledFile samples;
  if (file.header.empty()) return samples;
  const std::vector<std::size_t> columns = columns_of(file.header, names);
  for (const std::vector<CsvCell>& row : file.rows) {
    samples.t.push_back(number_in(row[columns[0]]));
    for (std::size_t a = 1; a < columns.size(); ++a) samples.q.push_back(number_in(row[columns[a]]));
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
