#include "study/modelling.hpp"

#include <fmt/format.h>

namespace extremal {
namespace {

/// The texts that compile() reads and, under the names that its errors have, their places.
struct Texts {
  SystemText system;
  std::map<std::string, Text> places;
};

ParameterText parameter(const Assignment& a) {
  ParameterText text;
  text.list = a.list;
  for (const Quantity& q : a.values) text.value.push_back(std::get<double>(q.value));
  return text;
}

Texts gather(const SystemTable& table) {
  Texts texts;
  for (const Text& c : table.coordinates) {
    texts.places[fmt::format("coordinates[{}]", texts.system.coordinates.size())] = c;
    texts.system.coordinates.push_back(c.value);
  }
  for (const Assignment& p : table.parameters) {
    texts.places["parameters." + p.name] = {p.name, p.name_at};
    texts.system.parameters[p.name] = parameter(p);
  }
  for (const Definition& d : table.definitions) {
    texts.places["definitions." + d.name] = d.formula;
    texts.system.definitions[d.name] = d.formula.value;
  }
  texts.places["lagrangian"] = *table.lagrangian;
  texts.system.lagrangian = table.lagrangian->value;
  return texts;
}

}  // namespace

System make_system(const SystemTable& table) {
  const Texts texts = gather(table);
  try {
    return compile(texts.system);
  } catch (const FormulaError& e) {
    const auto place = texts.places.find(e.where);
    throw SceneError(place == texts.places.end() ? table.at : position(place->second, e.offset), e.what());
  } catch (const std::invalid_argument& e) {
    throw SceneError(table.lagrangian->at, e.what());
  }
}

}  // namespace extremal
