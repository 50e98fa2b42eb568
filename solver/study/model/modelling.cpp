#include "study/model/modelling.hpp"

#include <fmt/format.h>

#include "system/hamiltonian.hpp"

namespace extremal {
namespace {

std::string force_place(const Assignment& force, std::size_t value) {
  return force.list ? fmt::format("force.{}[{}]", force.name, value + 1) : "force." + force.name;
}

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
  for (std::size_t k = 0; k < table.constraints.size(); ++k)
    places[fmt::format("constraints[{}]", k)] = table.constraints[k];
  for (const Assignment& force : table.force)
    for (std::size_t k = 0; k < force.values.size(); ++k)
      if (const auto* formula = std::get_if<std::string>(&force.values[k].value))
        places[force_place(force, k)] = {*formula, force.values[k].at};
  return places;
}

std::string formula_of(const Quantity& quantity) {
  return quantity.formula() ? std::get<std::string>(quantity.value)
                            : fmt::format("{}", std::get<double>(quantity.value));
}

/// One entry for each formula; that of a whole array serves all of its elements.
std::vector<ForceText> forces_of(const SystemTable& table, const System& system) {
  std::vector<ForceText> forces;
  std::vector<const Assignment*> given(system.names.size());
  for (const Assignment& force : table.force) {
    const Range range = range_of(force.name, force.name_at, system);
    const std::size_t before = forces.size();
    for_each_value(force, range, [&](int coordinate, const Quantity& value, int index) {
      if (given[coordinate])
        throw SceneError(force.name_at, fmt::format("the force on {} is given by '{}' already",
                                                    system.names[coordinate], given[coordinate]->name));
      given[coordinate] = &force;
      const bool shared = range.array && !force.list;
      if (shared && forces.size() > before) {
        ++forces.back().count;
        return;
      }
      const auto k = static_cast<std::size_t>(&value - force.values.data());
      forces.push_back({coordinate, 1, index, formula_of(value), force_place(force, k)});
    });
  }
  return forces;
}

}  // namespace

SystemText system_text(const SystemTable& table) {
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

FaultyFormula at_its_place(const SystemTable& table, const FormulaError& e) {
  const std::map<std::string, Text> places = places_of(table);
  const auto place = places.find(e.where);
  return {place == places.end() ? table.at : position(place->second, e.offset), e.what()};
}

System make_system(const SystemTable& table, const std::vector<std::string>& active, Formulation formulation,
                   bool replaceable) {
  try {
    SystemText text = system_text(table);
    text.active = active;
    text.replaceable = replaceable;
    System system = compile(text, formulation);
    if (!table.force.empty() && formulation == Formulation::phase_space)
      throw SceneError(
          table.force.front().name_at,
          "forces need a Hamiltonian whose second derivative by the momenta is regular; write the "
          "'lagrangian', or leave 'force' out");
    if (!table.force.empty()) system.copies = compile_forces(text, forces_of(table, system));
    return system;
  } catch (const FormulaError& e) {
    throw at_its_place(table, e);
  } catch (const SingularHamiltonian& e) {
    throw NoLegendreTransform(table.law().at, e.what());
  } catch (const std::invalid_argument& e) {
    throw SceneError(table.law().at, e.what());
  }
}

std::shared_ptr<const Lagrangian> make_copies(const SystemTable& table, int constants) {
  SystemTable without = table;
  without.force.clear();
  const std::vector<ForceText> forces = forces_of(table, make_system(without));
  try {
    return compile_forces(system_text(table), forces, constants);
  } catch (const FormulaError& e) {
    throw at_its_place(table, e);
  }
}

namespace {

ConstrainedGraph constrained_with(const SystemTable& table, const std::vector<ForceText>& forces,
                                  const std::vector<std::string>& active) {
  std::vector<ConstraintText> constraints;
  for (std::size_t k = 0; k < table.constraints.size(); ++k)
    constraints.push_back({table.constraints[k].value, fmt::format("constraints[{}]", k)});
  try {
    SystemText text = system_text(table);
    text.active = active;
    return constrained_graph(text, constraints, forces);
  } catch (const FormulaError& e) {
    throw at_its_place(table, e);
  }
}

}  // namespace

ConstrainedGraph make_constrained(const SystemTable& table) { return constrained_with(table, {}, {}); }

ConstrainedGraph make_constrained(const SystemTable& table, const System& system,
                                  const std::vector<std::string>& active) {
  return constrained_with(table, forces_of(table, system), active);
}

}  // namespace extremal
