#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/commands.hpp"
#include "app/lines.hpp"
#include "app/terminal.hpp"
#include "report/text.hpp"
#include "study/inspection.hpp"

namespace extremal::app {
namespace {

void print_entries(const char* title, const std::vector<CatalogueEntry>& entries) {
  std::size_t width = 0;
  for (const CatalogueEntry& e : entries) width = std::max(width, e.name.size());
  print(fmt::format("{}\n", title));
  for (const CatalogueEntry& e : entries)
    print(fmt::format("  {:<{}}  {}\n", visible(e.name, false), width, visible(e.help, false)));
}

int list_all() {
  const Catalogue found = catalogue();
  print_entries("Systems (system.use); one of them: extremal list SYSTEM", found.systems);
  print_entries("\nSchemes (solve.scheme)", found.schemes);
  print_entries("\nMethods (solve.method)", found.methods);
  return Exit::done;
}

void print_formulas(const SystemTable& system) {
  std::vector<std::string> coordinates, parameters, definitions;
  for (const Assignment& p : system.parameters) parameters.push_back(assignment_text(p));
  for (const Text& c : system.coordinates) coordinates.push_back(c.value);
  for (const Definition& d : system.definitions)
    definitions.push_back(fmt::format("{} = {}", d.name, d.formula.value));
  line("coordinates", fmt::format("{}", fmt::join(coordinates, ", ")));
  lines("parameters", parameters);
  lines("definitions", definitions);
  if (system.lagrangian) line("Lagrangian", system.lagrangian->value);
  if (system.hamiltonian) line("Hamiltonian", system.hamiltonian->value);
  std::vector<std::string> forces;
  for (const Assignment& force : system.force) forces.push_back(assignment_text(force));
  lines("forces", forces);
  std::vector<std::string> constraints;
  for (const Text& constraint : system.constraints) constraints.push_back(constraint.value);
  lines("constraints", constraints);
}

}  // namespace

int list(const std::string& system) {
  if (system.empty()) return list_all();
  const SystemDescription found = describe(system, "extremal list");
  line("system", found.name);
  for (const AboutEntry& note : found.about) lines(note.name, note.texts);
  print_formulas(found.system);
  line("file", found.path);
  lines("scenes", found.scenes);
  return Exit::done;
}

}  // namespace extremal::app
