#include "study/model/naming.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "system/formula_syntax.hpp"

namespace extremal {
namespace {

/// The index in "x[2]", written without blanks; 0 if there is none.
int index_of(const std::string& name, std::size_t bracket) {
  int index = 0;
  const char *begin = name.data() + bracket + 1, *end = name.data() + name.size() - 1;
  if (name.back() != ']') return 0;
  const auto [stop, error] = std::from_chars(begin, end, index);
  return error == std::errc() && stop == end ? index : 0;
}

}  // namespace

double evaluate(const Quantity& quantity, const Vocabulary& vocabulary, int index) {
  if (!quantity.formula()) return std::get<double>(quantity.value);
  const Text text{std::get<std::string>(quantity.value), quantity.at};
  const double value =
      placed(text, [&](const std::string& formula) { return number(formula, vocabulary, "", index); });
  if (!std::isfinite(value))
    throw SceneError(position(text, 0), fmt::format("'{}' is not finite", text.value));
  return value;
}

double evaluate_beside(const std::vector<std::string>& words, const Quantity& quantity,
                       const Vocabulary& vocabulary) {
  const std::string* const written = std::get_if<std::string>(&quantity.value);
  if (!written || !formula::is_name(*written)) return evaluate(quantity, vocabulary);
  const Text text{*written, quantity.at};
  std::vector<std::string> known;
  for (const auto& [name, value] : vocabulary.parameters) known.push_back(name);
  for (const auto& [name, definition] : vocabulary.definitions) known.push_back(name);
  known.insert(known.end(), words.begin(), words.end());
  if (std::ranges::find(words, nearest_name(text.value, known)) != words.end())
    throw UnknownName(position(text, 0), fmt::format("unknown name '{}'", text.value), text.value,
                      std::move(known));
  return evaluate(quantity, vocabulary);
}

bool is_momentum(const std::string& name, const System& system) {
  if (!name.starts_with("p_")) return false;
  const auto named = [&](const std::string& stem) {
    return std::ranges::any_of(system.coordinates, [&](const Coordinate& c) { return c.name == stem; });
  };
  const std::string stem = name.substr(0, name.find_first_of("['"));
  return system.hamiltonian ? named(stem) : !named(stem) && named(stem.substr(2));
}

Range range_of(const std::string& name, const Location& at, const System& system,
               std::vector<std::string> keys) {
  const std::size_t bracket = name.find('[');
  const std::string stem = name.substr(0, bracket);
  for (const Coordinate& c : system.coordinates) {
    if (c.name != stem) continue;
    if (bracket == std::string::npos) return {c.first, c.count, c.array, c.array};
    if (!c.array)
      throw SceneError(at, fmt::format("'{0}' is not an array; write '{0}' in place of '{1}'", stem, name));
    const int index = index_of(name, bracket);
    if (index < 1 || index > c.count)
      throw SceneError(at,
                       fmt::format("'{}' is out of range: '{}' has elements 1 to {}", name, stem, c.count));
    return {c.first + index - 1, 1, false, index};
  }
  std::vector<std::string> coordinates;
  for (const Coordinate& c : system.coordinates) coordinates.push_back(c.name);
  if (const std::string meant = velocity_meant(stem, system.coordinates); !meant.empty())
    throw SceneError(at, fmt::format("unknown coordinate '{}'; velocities are written \"{}'\", and only "
                                     "'state' in [guess] holds them",
                                     name, meant));
  const auto is_coordinate = [&](const std::string& other) {
    return std::ranges::find(coordinates, other) != coordinates.end();
  };
  if (stem.starts_with("p_") && is_coordinate(stem.substr(2)))
    throw SceneError(at, fmt::format("'{}' is a momentum, and a coordinate stands here; momenta are given in "
                                     "'start' and 'end' of [boundary], and a state in [guess] has "
                                     "velocities, \"{}'\"",
                                     name, name.substr(2)));
  if (stem.ends_with("'") && is_coordinate(stem.substr(0, stem.size() - 1)))
    throw SceneError(at, fmt::format("\"{}\" is a velocity, and a coordinate stands here", name));
  keys.insert(keys.end(), coordinates.begin(), coordinates.end());
  constexpr std::size_t most_shown = 12;
  const std::string known =
      coordinates.size() > most_shown ? "" : fmt::format("; the system has {}", fmt::join(coordinates, ", "));
  throw UnknownName(at, fmt::format("unknown coordinate '{}'{}", name, known), stem, std::move(keys));
}

void for_each_value(const Assignment& assignment, const Range& range,
                    const std::function<void(int, const Quantity&, int)>& f) {
  const int given = static_cast<int>(assignment.values.size());
  const bool for_all = range.array && !assignment.list;
  if (for_all && !assignment.values.front().formula())
    throw SceneError(
        assignment.at,
        fmt::format("'{0}' has {1} elements; give a list of {1} values, a formula in the index "
                    "i (\"{2}\" for all alike), or \"{0}[1]\" = … for one element",
                    assignment.name, range.count, std::get<double>(assignment.values.front().value)));
  if (!range.array && assignment.list)
    throw SceneError(assignment.at,
                     fmt::format("'{}' is one number; found a list of {}", assignment.name, given));
  if (given != range.count && !for_all)
    throw SceneError(assignment.at, fmt::format("'{}' has {} elements; found {} values", assignment.name,
                                                range.count, given));
  for (int k = 0; k < range.count; ++k)
    f(range.first + k, assignment.values[for_all ? 0 : k], range.index > 0 ? range.index + k : 0);
}

}  // namespace extremal
