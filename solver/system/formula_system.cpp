#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "system/constraints.hpp"
#include "system/copies.hpp"
#include "system/formula_graph.hpp"
#include "system/hamiltonian.hpp"
#include "system/phase_space.hpp"

namespace extremal {

namespace {

/// By the Legendre transform. Momenta that it does not determine are named.
std::shared_ptr<const Lagrangian> compile_hamiltonian(formula::Names& names, const SystemText& text,
                                                      std::span<const std::string> coordinates) {
  try {
    return make_lagrangian_of(formula::graph_of(names, *text.hamiltonian, "hamiltonian"));
  } catch (const SingularHamiltonian& e) {
    constexpr std::size_t most = 6;
    std::vector<std::string> momenta;
    for (const int a : e.momenta) momenta.push_back("p_" + coordinates[a]);
    if (momenta.size() > most) momenta[most] = "…";
    momenta.resize(std::min(momenta.size(), most + 1));
    throw SingularHamiltonian(
        fmt::format("H_pp is singular: the velocities do not determine {}; the second derivative of the "
                    "Hamiltonian by the momenta must be regular",
                    fmt::join(momenta, ", ")),
        e.momenta);
  }
}

/// The Lagrangian of which two copies are made.
LagrangianGraph transformed(const LagrangianGraph& hamiltonian) {
  std::optional<LagrangianGraph> lagrangian = legendre_transform(hamiltonian);
  if (!lagrangian)
    throw std::invalid_argument(
        "forces act on Hamiltonians that are made of quadratic forms of the momenta or of square roots of "
        "such; write the 'lagrangian' instead");
  return *std::move(lagrangian);
}

/// Behind the coordinates.
void add_momenta(System& system) {
  const int n = static_cast<int>(system.names.size());
  for (int a = 0; a < n; ++a) system.names.push_back("p_" + system.names[a]);
  const std::vector<Coordinate> coordinates = system.coordinates;
  for (Coordinate momentum : coordinates) {
    momentum.name = "p_" + momentum.name;
    momentum.first += n;
    system.coordinates.push_back(std::move(momentum));
  }
}

}  // namespace

System compile(const SystemText& text, Formulation formulation) {
  formula::Names names = formula::names_of(text);
  System system;
  system.parameters = text.parameters;
  system.definitions = text.definitions;
  for (const Coordinate& coordinate : names.coordinates) {
    if (!coordinate.array) system.names.push_back(coordinate.name);
    for (int i = 1; coordinate.array && i <= coordinate.count; ++i)
      system.names.push_back(fmt::format("{}[{}]", coordinate.name, i));
  }
  system.coordinates = names.coordinates;
  if (text.hamiltonian && formulation == Formulation::phase_space) {
    add_momenta(system);
    system.hamiltonian =
        std::make_shared<const LagrangianGraph>(formula::graph_of(names, *text.hamiltonian, "hamiltonian"));
    system.lagrangian = phase_lagrangian(*system.hamiltonian, {});
    return system;
  }
  system.lagrangian = text.hamiltonian
                          ? compile_hamiltonian(names, text, system.names)
                          : make_lagrangian(formula::graph_of(names, text.lagrangian, "lagrangian"));
  return system;
}

std::shared_ptr<const Lagrangian> compile_forces(const SystemText& text, std::span<const ForceText> forces,
                                                 int shared) {
  SystemText of_velocities = text;
  of_velocities.hamiltonian.reset();
  formula::Names names = formula::names_of(text), of_forces = formula::names_of(of_velocities);
  const LagrangianGraph lagrangian =
      text.hamiltonian ? transformed(formula::graph_of(names, *text.hamiltonian, "hamiltonian"))
                       : formula::graph_of(names, text.lagrangian, "lagrangian");
  return make_lagrangian(two_copies(lagrangian, formula::power_of(of_forces, forces), shared));
}

ConstrainedGraph constrained_graph(const SystemText& text, std::span<const ConstraintText> constraints,
                                   std::span<const ForceText> forces) {
  formula::Names names = formula::names_of(text);
  const LagrangianGraph lagrangian = formula::graph_of(names, text.lagrangian, "lagrangian");
  ConstrainedGraph system;
  system.coordinates = lagrangian.coordinates;
  system.parameters.assign(lagrangian.uniforms.begin(), lagrangian.uniforms.begin() + lagrangian.parameters);
  system.lagrangian = flattened(lagrangian, system.graph);
  for (const ConstraintText& constraint : constraints) {
    const LagrangianGraph equation = formula::equation_of(names, constraint.formula, constraint.where);
    system.constraints.push_back(flattened(equation, system.graph));
    if (has_kinks(system.graph, system.constraints.back()))
      throw FormulaError("a constraint must be smooth, without abs, min, max and step", constraint.where, 0);
  }
  if (!forces.empty()) {
    formula::Names of_forces = formula::names_of(text);
    system.forces = forces_of_power(formula::power_of(of_forces, forces), system.graph);
  }
  return system;
}

}  // namespace extremal
