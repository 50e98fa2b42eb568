#include "study/modelling.hpp"

#include <fmt/format.h>

namespace extremal {
namespace {

/// The texts of a system under the names that their errors have.
std::map<std::string, Text> places_of(const SystemTable& table) {
  std::map<std::string, Text> places;
  for (std::size_t k = 0; k < table.coordinates.size(); ++k)
    places[fmt::format("coordinates[{}]", k)] = table.coordinates[k];
  for (const Assignment& p : table.parameters) {
    places["parameters." + p.name] = {p.name, p.name_at};
    for (std::size_t k = 0; k < p.values.size(); ++k)
      if (const auto* formula = std::get_if<std::string>(&p.values[k].value))
        places[fmt::format("parameters.{}[{}]", p.name, k + 1)] = {*formula, p.values[k].at};
  }
  for (const Definition& d : table.definitions) places["definitions." + d.name] = d.formula;
  places[table.hamiltonian ? "hamiltonian" : "lagrangian"] = table.law();
  return places;
}

SystemText text_of(const SystemTable& table) {
  SystemText text;
  for (const Text& c : table.coordinates) text.coordinates.push_back(c.value);
  for (const Definition& d : table.definitions) text.definitions[d.name] = d.formula.value;
  std::map<std::string, ParameterEntry> entries;
  for (const Assignment& p : table.parameters) {
    ParameterEntry& entry = entries[p.name];
    entry.list = p.list;
    for (const Quantity& q : p.values) entry.values.push_back(q.value);
  }
  text.parameters = evaluate_parameters(entries, text.definitions);
  if (table.lagrangian) text.lagrangian = table.lagrangian->value;
  if (table.hamiltonian) text.hamiltonian = table.hamiltonian->value;
  return text;
}

}  // namespace

SceneError at_its_place(const SystemTable& table, const FormulaError& e) {
  const std::map<std::string, Text> places = places_of(table);
  const auto place = places.find(e.where);
  return {place == places.end() ? table.at : position(place->second, e.offset), e.what()};
}

System make_system(const SystemTable& table) {
  try {
    return compile(text_of(table));
  } catch (const FormulaError& e) {
    throw at_its_place(table, e);
  } catch (const std::invalid_argument& e) {
    throw SceneError(table.law().at, e.what());
  }
}

}  // namespace extremal
