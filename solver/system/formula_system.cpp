#include <fmt/format.h>

#include <utility>

#include "system/copies.hpp"
#include "system/formula_graph.hpp"

namespace extremal {

System compile(const SystemText& text) {
  formula::Names names = formula::names_of(text);
  System system;
  system.lagrangian = make_lagrangian(formula::graph_of(names, text.lagrangian));
  system.parameters = text.parameters;
  system.definitions = text.definitions;
  for (const Coordinate& coordinate : names.coordinates) {
    if (!coordinate.array) system.names.push_back(coordinate.name);
    for (int i = 1; coordinate.array && i <= coordinate.count; ++i)
      system.names.push_back(fmt::format("{}[{}]", coordinate.name, i));
  }
  system.coordinates = std::move(names.coordinates);
  return system;
}

std::shared_ptr<const Lagrangian> compile_forces(const SystemText& text, std::span<const ForceText> forces) {
  formula::Names names = formula::names_of(text), of_forces = formula::names_of(text);
  const LagrangianGraph lagrangian = formula::graph_of(names, text.lagrangian);
  return make_lagrangian(two_copies(lagrangian, formula::power_of(of_forces, forces)));
}

}  // namespace extremal
