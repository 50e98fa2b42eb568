#include "study/inspection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "action/scheme.hpp"
#include "problem/extension.hpp"
#include "scene/schema.hpp"
#include "scene/systems.hpp"
#include "study/suggestion.hpp"
#include "system/formula.hpp"
#include "system/hamiltonian.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {
namespace {

std::vector<Inspection::Tape> tapes_of(const Lagrangian& lagrangian) {
  const auto* tape = dynamic_cast<const TapeLagrangian*>(&lagrangian);
  std::vector<Inspection::Tape> tapes;
  if (!tape) return tapes;
  for (const auto& [order, text] : {std::pair(Order::value, "value"), std::pair(Order::gradient, "gradient"),
                                    std::pair(Order::hessian, "Hessian")}) {
    const TapeSummary summary = tape->summary(order);
    tapes.push_back({text, summary.kernels, summary.instructions, summary.played});
  }
  return tapes;
}

/// Constants to be found, and points in between.
void read_extension(const Problem& problem, Inspection& found) {
  if (!problem.extension) return;
  const Extension& extension = *problem.extension;
  for (int k = 0; k < extension.unknowns(); ++k)
    found.unknowns.push_back(fmt::format("{} (from {:.6g})", extension.names[k], extension.guess[k]));
  for (const WaypointCondition& point : extension.waypoints) {
    std::vector<std::string> fixed;
    for (const auto& [a, value] : point.fixed)
      fixed.push_back(fmt::format("{} = {:.6g}", problem.names[a], value));
    const std::string time = point.free
                                 ? fmt::format("t free, from {:.6g}", point.time * problem.duration.value)
                                 : fmt::format("t = {:.6g}", point.time);
    found.waypoints.push_back(fmt::format("{}: {}", time, fmt::join(fixed, ", ")));
  }
}

/// What a name that no system has may be meant for: that of a scene, or one that is near.
std::string other_name(const std::string& name, const std::vector<std::string>& systems) {
  const std::vector<SceneFile> scenes = scene_files();
  const auto find = [&](const std::string& wanted) {
    return std::ranges::find(scenes, wanted, &SceneFile::name);
  };
  if (const auto scene = find(name); scene != scenes.end())
    return fmt::format("; it is the name of the scene '{}'{}", scene->path,
                       scene->system.empty() ? "" : fmt::format(", whose system is '{}'", scene->system));
  if (std::string near = suggestion(name, systems); !near.empty()) return near;
  std::vector<std::string> names;
  for (const SceneFile& scene : scenes) names.push_back(scene.name);
  const auto scene = find(nearest_name(name, names));
  return scene == scenes.end() ? "" : fmt::format("; did you mean the scene '{}'?", scene->path);
}

}  // namespace

Inspection inspect(const Study& study) {
  const Structure& structure = study.system.lagrangian->structure();
  Inspection found;
  found.autonomous = structure.autonomous;
  found.quadratic = structure.quadratic;
  found.velocity_free = structure.velocity_free;
  found.mass_entries = static_cast<int>(structure.mass.size());
  found.gyroscopic_entries = static_cast<int>(structure.gyroscopic.size());
  for (const HessianEntry& e : structure.hessian) {
    const int n = structure.coordinates;
    ++(e.row < n ? found.qq : e.column < n ? found.vq : found.vv);
  }
  if (const Kinks* kinks = study.system.lagrangian->kinks())
    found.kinks = static_cast<int>(kinks->surfaces().size());
  const Lagrangian* hamiltonian = hamiltonian_of(*study.system.lagrangian);
  found.momenta_solved = hamiltonian != nullptr;
  found.tapes = tapes_of(hamiltonian ? *hamiltonian : *study.system.lagrangian);
  read_extension(study.problem, found);
  found.derivatives = check_derivatives(study.problem, deadline_of(study));
  if (!study.problem.pair) return found;
  found.forces_autonomous = study.problem.copies->structure().autonomous;
  found.with_forces = check_derivatives(*study.problem.pair, deadline_of(study));
  return found;
}

Catalogue catalogue() {
  Catalogue found;
  for (const SystemFile& file : system_files()) found.systems.push_back({file.name, file.about});
  for (const Scheme& s : schemes())
    found.schemes.push_back({s.name, fmt::format("degree {}, order {}; {}", s.degree, s.order, s.source)});
  for (const MethodRecord& m : method_records())
    found.methods.push_back({std::string(m.name), std::string(m.help)});
  return found;
}

SystemDescription describe(const std::string& system, const std::string& command) {
  try {
    return describe_system(system, command);
  } catch (const UnknownName& e) {
    throw SceneError(e.at, e.message + other_name(system, e.known));
  }
}

std::string example_scene() {
  const std::string found = find_scene("kepler");
  return found.empty() ? "scene.toml" : found;
}

}  // namespace extremal
