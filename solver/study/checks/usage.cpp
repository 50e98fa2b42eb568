#include "study/checks/usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "system/formula.hpp"

namespace extremal {
namespace {

/// The names in the formulas of a scene.
class NamesUsed {
 public:
  explicit NamesUsed(const Scene& scene) {
    add(scene.system);
    add(scene.boundary);
    add(scene.waypoints);
    add(scene.guess);
    if (scene.inequalities) add_inequalities(scene.inequalities->constraints);
    if (scene.fit) add(scene.fit->observe);
    if (scene.continuation) names_.insert(scene.continuation->parameter.value);
  }
  bool contains(const std::string& name) const { return names_.contains(name); }

 private:
  void add(const std::string& formula) { names_.merge(names_in(formula)); }
  void add(const Text& text) { add(text.value); }
  void add(const Quantity& quantity) {
    if (const auto* formula = std::get_if<std::string>(&quantity.value)) add(*formula);
  }
  void add(const Assignment& assignment) { add(assignment.values); }
  void add(const Definition& definition) { add(definition.formula); }
  template <class Part>
  void add(const std::vector<Part>& parts) {
    for (const Part& part : parts) add(part);
  }
  template <class Part>
  void add(const std::optional<Part>& part) {
    if (part) add(*part);
  }
  /// No formula has < and >.
  void add_inequalities(const std::vector<Text>& inequalities) {
    for (Text text : inequalities) {
      std::ranges::replace(text.value, '<', ' ');
      std::ranges::replace(text.value, '>', ' ');
      add(text);
    }
  }
  void add(const SystemTable& system) {
    add(system.coordinates);
    add(system.parameters);
    add(system.definitions);
    add(system.lagrangian);
    add(system.hamiltonian);
    add(system.force);
    add(system.constraints);
  }
  void add(const BoundaryTable& boundary) {
    for (const auto* ends : {&boundary.start, &boundary.end, &boundary.map}) add(*ends);
    add(boundary.conditions);
    add(boundary.duration);
    add(boundary.energy);
    add(boundary.where);
    add(boundary.where_list);
    add(boundary.integrals);
  }
  void add(const WaypointTable& waypoint) {
    add(waypoint.time);
    add(waypoint.values);
  }
  void add(const GuessTable& guess) {
    add(guess.formulas);
    add(guess.state);
    add(guess.duration);
  }

  std::set<std::string> names_;
};

bool of_scene(const Location& at, const Scene& scene) {
  return at.source && (!at.source->numbered || at.source->name == scene.path);
}

}  // namespace

void check_parameters_used(const Scene& scene) {
  const NamesUsed used(scene);
  std::vector<std::string> known;
  for (const Assignment& p : scene.system.parameters)
    if (used.contains(p.name)) known.push_back(p.name);
  const std::string others =
      known.empty() ? "" : fmt::format("; the formulas use {}", fmt::join(known, ", "));
  for (const Assignment& p : scene.system.parameters)
    if (!used.contains(p.name) && of_scene(p.name_at, scene))
      throw UnknownName(p.name_at, fmt::format("nothing uses the parameter '{}'{}", p.name, others), p.name,
                        known);
}

}  // namespace extremal
