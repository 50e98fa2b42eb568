#include "study/files/guess_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "study/files/csv_file.hpp"
#include "study/files/formats.hpp"
#include "study/files/json_file.hpp"
#include "study/files/numpy.hpp"

namespace extremal {
namespace {

using Json = nlohmann::json;
using SourcePointer = std::shared_ptr<const Source>;

/// A path by columns, the first the time.
class Columns {
 public:
  explicit Columns(const Location& whole) : whole_(whole) {}

  void add(const std::string& name, std::vector<double> values) {
    columns_.push_back(std::move(values));
    const std::size_t count = columns_.front().size(), found = columns_.back().size();
    if (found != count)
      throw SceneError(whole_,
                       fmt::format("the samples have {} times and {} values of '{}'", count, found, name));
  }

  GuessFile path() const {
    GuessFile path;
    path.t = columns_.front();
    check_times(path.t, [&](std::size_t) { return whole_; });
    for (std::size_t k = 0; k < path.t.size(); ++k)
      for (std::size_t a = 1; a < columns_.size(); ++a) path.q.push_back(columns_[a][k]);
    return path;
  }

 private:
  Location whole_;
  std::vector<std::vector<double>> columns_;
};

/// Rows of one path; those of a search are numbered from 1 in a first column.
std::vector<const std::vector<CsvCell>*> rows_of_path(const CsvFile& file, const SourcePointer& source,
                                                      const std::vector<std::string>& names,
                                                      const std::optional<Number>& orbit) {
  std::vector<const std::vector<CsvCell>*> rows;
  const bool numbered = file.header.front().text == "solution" && !std::ranges::count(names, "solution");
  double last = 1;
  for (const std::vector<CsvCell>& row : file.rows)
    if (numbered) last = std::max(last, number_in(row.front()));
  const auto count = static_cast<std::size_t>(std::min(last, static_cast<double>(file.rows.size()) + 1));
  const std::size_t chosen = chosen_row(count, orbit, source);
  for (const std::vector<CsvCell>& row : file.rows)
    if (!numbered || number_in(row.front()) == static_cast<double>(chosen + 1)) rows.push_back(&row);
  return rows;
}

GuessFile read_csv_guess(const SourcePointer& source, const std::vector<std::string>& names,
                         const std::optional<Number>& orbit) {
  const CsvFile file = read_csv(source);
  if (file.header.empty())
    throw SceneError({source, 0, 0}, "the file has no columns; write a column t and one for each coordinate");
  const auto find = [&](const std::string& name) {
    return std::find_if(file.header.begin(), file.header.end(),
                        [&](const CsvCell& c) { return c.text == name; });
  };
  const std::vector<std::string> coordinates(names.begin() + 1, names.end());
  if (find("t") == file.header.end() && has_velocities(file, coordinates))
    return read_orbit_table(file, source, coordinates, orbit);
  GuessFile path;
  std::vector<std::size_t> columns;
  for (const std::string& name : names) {
    if (find(name) == file.header.end()) throw missing_column(file, name);
    columns.push_back(find(name) - file.header.begin());
  }
  const std::vector<const std::vector<CsvCell>*> rows = rows_of_path(file, source, names, orbit);
  for (const std::vector<CsvCell>* row : rows) {
    path.t.push_back(number_in((*row)[columns[0]]));
    for (std::size_t a = 1; a < columns.size(); ++a) path.q.push_back(number_in((*row)[columns[a]]));
  }
  check_times(path.t, [&](std::size_t k) {
    return rows.empty() ? file.header.front().at : (*rows[k])[columns[0]].at;
  });
  return path;
}

/// Of a result the first solution is the result itself; of a branch each point is one.
const Json& chosen_solution(const Json& root, const std::optional<Number>& orbit,
                            const SourcePointer& source) {
  const auto solutions = root.find("solutions"), points = root.find("points");
  if (points != root.end() && points->is_array()) return (*points)[chosen_row(points->size(), orbit, source)];
  if (!orbit) return root;
  const bool several = solutions != root.end() && solutions->is_array();
  const std::size_t row = chosen_row(several ? solutions->size() : 1, orbit, source);
  return several ? (*solutions)[row] : root;
}

GuessFile read_result(const SourcePointer& source, const std::vector<std::string>& names,
                      const std::optional<Number>& orbit) {
  const Location whole{source, 0, 0};
  const Json root = parse_json(source, "write the file with solve --output, or as CSV with a line of names");
  const Json& solution = root.is_object() ? chosen_solution(root, orbit, source) : root;
  const auto found = solution.is_object() ? solution.find("samples") : solution.end();
  if (!solution.is_object() || found == solution.end() || !found->is_object())
    throw SceneError(whole, "the file has no samples; write it with --samples 201 to have some");
  Columns columns(whole);
  for (const std::string& name : names) {
    const auto column = found->find(name);
    if (column == found->end()) throw SceneError(whole, fmt::format("the samples have no '{}'", name));
    const bool numbers = column->is_array() && std::all_of(column->begin(), column->end(), [](const Json& x) {
                           return x.is_number() && std::isfinite(x.get<double>());
                         });
    if (!numbers)
      throw SceneError(whole, fmt::format("'{}' of the samples is not a list of finite numbers", name));
    columns.add(name, column->get<std::vector<double>>());
  }
  return columns.path();
}

GuessFile read_arrays(const std::string& path, const std::vector<std::string>& names) {
  const SourcePointer source = read_binary(path);
  const Location whole{source, 0, 0};
  std::map<std::string, NumpyArray> arrays;
  try {
    arrays = read_npz(source->text, largest_binary);
  } catch (const std::runtime_error& e) {
    throw SceneError(whole, e.what());
  }
  Columns columns(whole);
  for (const std::string& name : names) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) throw SceneError(whole, fmt::format("the file has no array '{}'", name));
    std::vector<double>& values = found->second.values;
    if (!std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }))
      throw SceneError(whole, fmt::format("'{}' has values that are not finite", name));
    columns.add(name, std::move(values));
  }
  return columns.path();
}

GuessFile read_any(const std::string& path, const std::vector<std::string>& names,
                   const std::optional<Number>& orbit, SourcePointer& source) {
  std::vector<std::string> wanted{"t"};
  wanted.insert(wanted.end(), names.begin(), names.end());
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".npz" || ending == ".npy") {
    source = std::make_shared<Source>(Source{path, ""});
    chosen_row(1, orbit, source);
    return ending == ".npz" ? read_arrays(path, wanted) : read_loops(path, names);
  }
  source = read_source(path);
  const std::size_t first = source->text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && (source->text[first] == '{' || source->text[first] == '[')) {
    std::optional<GuessFile> table = read_json_table(source, names, orbit);
    return table ? *table : read_result(source, wanted, orbit);
  }
  return is_auto_file(source->text) ? read_auto_file(source, names, orbit)
                                    : read_csv_guess(source, wanted, orbit);
}

}  // namespace

void check_times(std::span<const double> t, const std::function<Location(std::size_t)>& place) {
  if (t.size() < 2)
    throw SceneError(place(0),
                     fmt::format("found {} sample{}; need at least 2", t.size(), t.empty() ? "s" : ""));
  for (std::size_t k = 1; k < t.size(); ++k)
    if (!(t[k] > t[k - 1]))
      throw SceneError(
          place(k),
          fmt::format("the times must increase; found {} after {}; order the rows by t, one path a file",
                      t[k], t[k - 1]));
}

GuessFile read_guess_file(const std::string& path, const std::vector<std::string>& names,
                          const std::optional<Number>& orbit) {
  SourcePointer source;
  GuessFile guess = read_any(path, names, orbit, source);
  const Location whole{source, 0, 0};
  if (!guess.start_q.empty()) {
    if (guess.duration && !(*guess.duration > 0))
      throw SceneError(whole, fmt::format("the period is {}; it must be positive", *guess.duration));
    return guess;
  }
  if (!guess.duration) guess.duration = guess.t.back() - guess.t.front();
  return guess;
}

}  // namespace extremal
