#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "study/files/formats.hpp"

namespace extremal {
namespace {

using SourcePointer = std::shared_ptr<const Source>;

/// The name of a column without its unit, in small letters.
std::string plain(std::string_view name) {
  std::string result(name.substr(0, name.find('(')));
  result.erase(result.find_last_not_of(" \t") + 1);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// Of the columns, the first that has one of these names.
std::optional<std::size_t> find_column(const std::vector<std::string>& columns,
                                       const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted) {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found != columns.end()) return found - columns.begin();
  }
  return {};
}

std::vector<std::string> velocity_names(const std::string& name) {
  return {name + "'", "v" + name, "v" + name + "0", name + "dot"};
}

std::vector<std::string> columns_of(const CsvFile& table) {
  std::vector<std::string> columns;
  for (const CsvCell& cell : table.header) columns.emplace_back(cell.text);
  return columns;
}

/// Columns of initial states.
struct StateColumns {
  std::vector<std::size_t> q, v;
  std::optional<std::size_t> period;
};

StateColumns state_columns(std::vector<std::string> columns, const std::vector<std::string>& names,
                           const Location& at) {
  for (std::string& name : columns) name = plain(name);
  const auto column = [&](const std::vector<std::string>& wanted) {
    const std::optional<std::size_t> found = find_column(columns, wanted);
    if (!found)
      throw SceneError(at, fmt::format("the file has no column '{}'; it has {}", wanted.front(),
                                       fmt::join(columns, ", ")));
    return *found;
  };
  StateColumns result;
  for (const std::string& declared : names) {
    const std::string name = plain(declared);
    result.q.push_back(column({name, name + "0"}));
    result.v.push_back(column(velocity_names(name)));
  }
  result.period = find_column(columns, {"period", "t", "duration"});
  return result;
}

template <class Value>
GuessFile state_in(const StateColumns& columns, Value&& value) {
  GuessFile guess;
  for (const std::size_t k : columns.q) guess.start_q.push_back(value(k));
  for (const std::size_t k : columns.v) guess.start_v.push_back(value(k));
  if (columns.period) guess.duration = value(*columns.period);
  return guess;
}

/// A number, or a string that holds one.
double number_in(const nlohmann::json& value, const std::string& column, const SourcePointer& source) {
  if (value.is_string()) return number_in(CsvCell{value.get_ref<const std::string&>(), {source, 0, 0}});
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw SceneError({source, 0, 0}, fmt::format("'{}' of an orbit is not a finite number", column));
  return value.get<double>();
}

}  // namespace

std::size_t chosen_row(std::size_t count, const std::optional<Number>& orbit, const SourcePointer& source) {
  if (count == 0) throw SceneError({source, 0, 0}, "the file has no orbits");
  if (!orbit && count == 1) return 0;
  if (!orbit)
    throw SceneError({source, 0, 0},
                     fmt::format("the file has {} orbits; say which in [guess], as orbit = 1", count));
  if (count == 1 && orbit->value != 1)
    throw SceneError(orbit->at, fmt::format("orbit = {}; '{}' has one orbit; leave 'orbit' out", orbit->value,
                                            source->name));
  if (!(orbit->value >= 1 && orbit->value <= static_cast<double>(count)))
    throw SceneError(
        orbit->at, fmt::format("orbit = {}; '{}' has the orbits 1 to {}", orbit->value, source->name, count));
  return static_cast<std::size_t>(orbit->value) - 1;
}

bool has_velocities(const CsvFile& table, const std::vector<std::string>& names) {
  std::vector<std::string> columns = columns_of(table);
  for (std::string& name : columns) name = plain(name);
  return std::ranges::any_of(names, [&](const std::string& declared) {
    return find_column(columns, velocity_names(plain(declared))).has_value();
  });
}

GuessFile read_orbit_table(const CsvFile& table, const SourcePointer& source,
                           const std::vector<std::string>& names, const std::optional<Number>& orbit) {
  const StateColumns wanted = state_columns(columns_of(table), names, table.header.front().at);
  const std::vector<CsvCell>& row = table.rows.at(chosen_row(table.rows.size(), orbit, source));
  return state_in(wanted, [&](std::size_t k) { return number_in(row[k]); });
}

std::optional<GuessFile> read_json_table(const SourcePointer& source, const std::vector<std::string>& names,
                                         const std::optional<Number>& orbit) {
  const Location whole{source, 0, 0};
  const nlohmann::json root = nlohmann::json::parse(source->text, nullptr, false);
  if (!root.is_object() || !root.contains("fields") || !root.contains("data")) return {};
  const nlohmann::json &fields = root["fields"], &rows = root["data"];
  const auto text = [](const nlohmann::json& x) { return x.is_string(); };
  if (!fields.is_array() || !std::all_of(fields.begin(), fields.end(), text) || !rows.is_array())
    throw SceneError(whole, "'fields' must be a list of names, 'data' a list of rows");
  const auto columns = fields.get<std::vector<std::string>>();
  const StateColumns wanted = state_columns(columns, names, whole);
  const nlohmann::json& row = rows[chosen_row(rows.size(), orbit, source)];
  if (!row.is_array() || row.size() != columns.size())
    throw SceneError(whole, fmt::format("an orbit must be a list of {} values", columns.size()));
  return state_in(wanted, [&](std::size_t k) { return number_in(row[k], columns[k], source); });
}

}  // namespace extremal
