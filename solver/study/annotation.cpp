#include "study/annotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "study/model/naming.hpp"
#include "study/study.hpp"
#include "study/suggestion.hpp"

namespace extremal {

namespace {

/// A part of a text and where it begins, without blanks around it.
struct Listed {
  std::string text;
  std::size_t offset = 0;
};

Listed trimmed(const std::string& text, std::size_t begin, std::size_t end) {
  while (begin < end && text[begin] == ' ') ++begin;
  while (end > begin && text[end - 1] == ' ') --end;
  return {text.substr(begin, end - begin), begin};
}

/// Parts between commas outside parentheses, of the text from `begin` to `end`.
std::vector<Listed> parts(const std::string& text, std::size_t begin, std::size_t end) {
  std::vector<Listed> found;
  int depth = 0;
  std::size_t from = begin;
  for (std::size_t k = begin; k < end; ++k) {
    if (text[k] == '(' || text[k] == '[') ++depth;
    if (text[k] == ')' || text[k] == ']') --depth;
    if (text[k] != ',' || depth > 0) continue;
    found.push_back(trimmed(text, from, k));
    from = k + 1;
  }
  found.push_back(trimmed(text, from, end));
  return found;
}

std::vector<std::string> axis_names(const System& system) {
  std::vector<std::string> names{"t", "energy", "action"};
  for (const Coordinate& coordinate : system.coordinates) names.push_back(coordinate.name);
  for (const auto& [name, value] : system.parameters) names.push_back(name);
  return names;
}

/// "x, y: km".
void read_axes(const Text& entry, const System& system, std::map<std::string, std::string>& units) {
  const std::size_t colon = entry.value.find(':');
  const std::string unit =
      colon == std::string::npos ? "" : trimmed(entry.value, colon + 1, entry.value.size()).text;
  if (unit.empty())
    throw SceneError(position(entry, 0),
                     "an entry of 'axes' names coordinates and their unit, as \"x, y: km\"");
  const std::vector<std::string> known = axis_names(system);
  for (const Listed& name : parts(entry.value, 0, colon)) {
    if (std::find(known.begin(), known.end(), name.text) == known.end())
      throw UnknownChoice(position(entry, name.offset), fmt::format("there is no axis '{}'", name.text),
                          name.text, known);
    units[name.text] = unit;
  }
}

/// "Earth: -mu, 0, 0".
Centre read_centre(const Text& entry, const System& system, const Vocabulary& vocabulary) {
  const std::size_t colon = entry.value.find(':');
  Centre centre;
  if (colon != std::string::npos) centre.name = trimmed(entry.value, 0, colon).text;
  const std::size_t begin = colon == std::string::npos ? 0 : colon + 1;
  const std::vector<Listed> formulas = parts(entry.value, begin, entry.value.size());
  if (formulas.size() != system.coordinates.size())
    throw SceneError(position(entry, begin),
                     fmt::format("a centre has one formula for each coordinate: {} are wanted, {} given",
                                 system.coordinates.size(), formulas.size()));
  for (const Listed& formula : formulas) {
    try {
      centre.at.push_back(number(formula.text, vocabulary, ""));
    } catch (const FormulaError& e) {
      throw FaultyFormula(position(entry, formula.offset + e.offset), e.what());
    }
  }
  return centre;
}

}  // namespace

Annotation annotation(const Study& study) {
  return with_suggestion([&] {
    Annotation read;
    for (const Text& entry : study.axes) read_axes(entry, study.system, read.units);
    Vocabulary last = study.system;
    if (study.continuation)
      if (const auto varied = last.parameters.find(study.continuation->parameter);
          varied != last.parameters.end())
        varied->second.value = {study.continuation->family.to};
    for (const Text& entry : study.centres) {
      Centre centre = read_centre(entry, study.system, study.system);
      if (read_centre(entry, study.system, last).at == centre.at) read.centres.push_back(std::move(centre));
    }
    return read;
  });
}

}  // namespace extremal
