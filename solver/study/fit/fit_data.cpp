#include "study/fit/fit_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "study/files/csv_file.hpp"
#include "study/guess/guess.hpp"

namespace extremal {
namespace {

constexpr std::string_view sigma = "sigma ";

/// Roundoff of times as they are written.
constexpr double slack = 1e-12;

/// What the columns of a file mean.
struct Columns {
  std::size_t time = 0;
  std::vector<ObservedColumn> observed;
  std::vector<std::size_t> values;                 ///< column of each
  std::vector<std::optional<std::size_t>> sigmas;  ///< likewise
};

std::vector<std::string> known_names(const FitTable& table, const System& system) {
  std::vector<std::string> names{"t"};
  for (const Definition& observation : table.observe) names.push_back(observation.name);
  for (const std::string& name : system.names) {
    names.push_back(name);
    names.push_back(name + "'");
  }
  return names;
}

/// The column of a name that is observed; throws UnknownChoice at the cell for another.
ObservedColumn column_of(const std::string& name, const CsvCell& cell, const FitTable& table,
                         const System& system) {
  for (std::size_t k = 0; k < table.observe.size(); ++k)
    if (table.observe[k].name == name)
      return {name,
              Observable::formula,
              static_cast<int>(k),
              turn_of(table.observe[k].formula.value, system),
              {}};
  const bool velocity = name.ends_with('\'');
  const auto found = std::ranges::find(system.names, velocity ? name.substr(0, name.size() - 1) : name);
  if (found != system.names.end())
    return {name,
            velocity ? Observable::velocity : Observable::coordinate,
            static_cast<int>(found - system.names.begin()),
            0,
            {}};
  throw UnknownChoice(cell.at,
                      fmt::format("unknown column '{}': it is no coordinate, no velocity and no name in "
                                  "fit.observe",
                                  name),
                      name, known_names(table, system));
}

Columns read_header(const CsvFile& file, const FitTable& table, const System& system) {
  Columns columns;
  std::vector<std::string> seen;
  const auto time = std::ranges::find(file.header, std::string_view("t"), &CsvCell::text);
  if (time == file.header.end()) throw missing_column(file, "t");
  columns.time = time - file.header.begin();
  for (std::size_t c = 0; c < file.header.size(); ++c) {
    const std::string name(file.header[c].text);
    if (std::ranges::find(seen, name) != seen.end())
      throw SceneError(file.header[c].at, fmt::format("there are two columns '{}'", name));
    seen.push_back(name);
    if (c != columns.time && !name.starts_with(sigma)) {
      columns.observed.push_back(column_of(name, file.header[c], table, system));
      columns.values.push_back(c);
    }
  }
  columns.sigmas.resize(columns.observed.size());
  for (std::size_t c = 0; c < file.header.size(); ++c) {
    const std::string name(file.header[c].text);
    if (!name.starts_with(sigma)) continue;
    const std::string of = name.substr(sigma.size());
    const auto found = std::ranges::find(columns.observed, of, &ObservedColumn::name);
    if (found == columns.observed.end())
      throw SceneError(file.header[c].at,
                       fmt::format("'{}' belongs to a column '{}', which the file does not have", name, of));
    columns.sigmas[found - columns.observed.begin()] = c;
  }
  return columns;
}

double read_time(const CsvCell& cell, double duration) {
  const double t = number_in(cell);
  if (t < -slack * duration || t > (1 + slack) * duration)
    throw SceneError(cell.at, fmt::format("t = {} is not between 0 and the duration, {}", t, duration));
  return t;
}

double read_sigma(const CsvCell& cell, const std::string& name) {
  if (cell.text.empty())
    throw SceneError(cell.at, fmt::format("'{0}' was observed here, and 'sigma {0}' is empty", name));
  const double value = number_in(cell);
  if (!(value > 0))
    throw SceneError(cell.at, fmt::format("sigma = {}; a standard deviation is positive", value));
  return value;
}

/// What stands before and after a call of atan2 that is a factor of the whole formula.
std::optional<std::string> without_atan2(const std::string& formula) {
  const std::size_t begin = formula.find("atan2(");
  if (begin == std::string::npos) return std::nullopt;
  int depth = 0;
  std::size_t end = formula.find('(', begin);
  for (; end < formula.size(); ++end) {
    if (formula[end] == '(') ++depth;
    if (formula[end] == ')' && --depth == 0) break;
  }
  if (end == formula.size()) return std::nullopt;
  const std::string before = formula.substr(0, begin), after = formula.substr(end + 1);
  const auto last = before.find_last_not_of(' ');
  const auto first = after.find_first_not_of(' ');
  const bool factor = last == std::string::npos || before[last] == '*' || (last == 0 && before[0] == '-');
  const bool divided = first == std::string::npos || after[first] == '*' || after[first] == '/';
  if (!factor || !divided) return std::nullopt;
  int open = 0;
  const std::string rest = before + "1" + after;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    open += (rest[k] == '(') - (rest[k] == ')');
    if (open == 0 && k > 0 && (rest[k] == '+' || rest[k] == '-')) return std::nullopt;
  }
  return rest;
}

}  // namespace

double turn_of(const std::string& formula, const Vocabulary& vocabulary) {
  const std::optional<std::string> factor = without_atan2(formula);
  if (!factor) return 0;
  try {
    const double turn = 2 * std::numbers::pi * std::abs(number(*factor, vocabulary, ""));
    return std::isfinite(turn) ? turn : 0;
  } catch (const FormulaError&) {
    return 0;
  }
}

Observations read_observations(const FitTable& table, const std::string& scene, const System& system,
                               double duration) {
  for (const Definition& observation : table.observe) {
    const std::vector<std::string>& names = system.names;
    if (std::ranges::find(names, observation.name) != names.end() || observation.name == "t")
      throw SceneError(
          observation.name_at,
          fmt::format("'{}' is a name of the system already; choose another one for the observation",
                      observation.name));
  }
  const std::string path = beside(scene, table.data.value);
  require_file(path, table.data);
  const auto source = read_source(path);
  const Location whole{source, 0, 0};
  const CsvFile file = read_csv(source);
  if (file.header.empty()) throw SceneError(whole, "the file has no columns; write a column t and others");
  Columns columns = read_header(file, table, system);
  for (const Definition& observation : table.observe)
    if (std::ranges::find(columns.observed, observation.name, &ObservedColumn::name) ==
        columns.observed.end())
      throw SceneError(observation.name_at, fmt::format("the data have no column '{}'", observation.name));
  Observations data;
  for (std::size_t k = 0; k < file.rows.size(); ++k) {
    const std::vector<CsvCell>& row = file.rows[k];
    data.t.push_back(read_time(row[columns.time], duration));
    for (std::size_t c = 0; c < columns.observed.size(); ++c) {
      ObservedColumn& column = columns.observed[c];
      const CsvCell& cell = row[columns.values[c]];
      if (cell.text.empty()) continue;
      column.values.push_back({static_cast<int>(k), number_in(cell), 1});
      if (columns.sigmas[c]) column.values.back().sigma = read_sigma(row[*columns.sigmas[c]], column.name);
    }
  }
  data.sigmas = std::ranges::any_of(columns.sigmas, [](const auto& c) { return c.has_value(); });
  data.columns = std::move(columns.observed);
  if (data.count() == 0) throw SceneError(whole, "the file has no observations");
  return data;
}

}  // namespace extremal
