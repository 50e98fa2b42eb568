#include "study/extension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/constrained_extension.hpp"
#include "study/guess/polyline.hpp"
#include "study/model/integrals.hpp"
#include "study/model/modelling.hpp"
#include "study/model/naming.hpp"
#include "study/model/unknown_constants.hpp"
#include "study/model/waypoints.hpp"

namespace extremal {

SystemTable table_at(const Scene& scene, const std::vector<double>& constants) {
  SystemTable table = scene.system;
  table.curvature.reset();
  const std::size_t unknowns = scene.boundary.unknowns.size();
  for (std::size_t k = 0; k < unknowns; ++k)
    for (Assignment& p : table.parameters)
      if (p.name == scene.boundary.unknowns[k].name) p.values.front().value = constants[k];
  if (constants.size() > unknowns)
    table.lagrangian =
        law_at(scene, {constants.begin() + static_cast<std::ptrdiff_t>(unknowns), constants.end()});
  return table;
}

namespace {

/// Of the points that stand for the ends where there are constraints.
EndCondition condition(const Text& text, const System& host, const Dependents& constants, const char* where,
                       const MovedEnds* ends) {
  const Rewritten written = rewritten(text.value, constants);
  try {
    return ends ? condition_of_points(written.text, host, where, *ends)
                : end_condition(written.text, host, where);
  } catch (const FormulaError& e) {
    if (e.where.starts_with("definitions.")) throw;
    throw FaultyFormula(position(text, written.original(e.offset)), e.what());
  }
}

std::string unused_name(const std::string& stem, const SystemTable& table) {
  std::set<std::string> taken;
  for (const Text& c : table.coordinates) taken.insert(c.value.substr(0, c.value.find('[')));
  for (const Assignment& p : table.parameters) taken.insert(p.name);
  for (const Definition& d : table.definitions) taken.insert(d.name);
  std::string name = stem;
  while (taken.contains(name)) name += "_";
  return name;
}

/// The system whose coordinates are those of the path, the unknowns and the multipliers.
SystemTable extended_table(const Scene& scene, const Dependents& dependents) {
  SystemTable table = scene.system;
  table.curvature.reset();
  std::erase_if(table.parameters, [&](const Assignment& p) {
    if (!dependents.contains(p.name)) return false;
    const auto is = [&](const Assignment& unknown) { return unknown.name == p.name; };
    if (std::ranges::any_of(scene.boundary.unknowns, is)) return true;
    if (p.list)
      throw SceneError(p.name_at, fmt::format("the list '{}' depends on an unknown; write its elements as "
                                              "definitions",
                                              p.name));
    table.definitions.push_back({p.name, p.name_at, {*as_formula(p.values.front()), p.values.front().at}});
    return true;
  });
  for (const Assignment& unknown : scene.boundary.unknowns)
    table.coordinates.push_back({unknown.name, unknown.name_at});
  std::vector<std::string> multipliers;
  for (const Text& integral : scene.boundary.integrals) {
    multipliers.push_back(unused_name(fmt::format("nu{}", multipliers.size() + 1), table));
    table.coordinates.push_back({multipliers.back(), integral.at});
  }
  if (!multipliers.empty()) table.lagrangian = law_with(scene, multipliers);
  return table;
}

SystemTable without_forces(SystemTable table) {
  table.force.clear();
  return table;
}

std::shared_ptr<const Lagrangian> lagrangian_at(const Scene& scene, const std::vector<double>& constants) {
  return make_system(without_forces(table_at(scene, constants))).lagrangian;
}

/// The guesses of the unknowns, and 1 for each multiplier.
std::vector<double> first_constants(const Scene& scene) {
  std::vector<double> constants;
  for (const Assignment& unknown : scene.boundary.unknowns)
    constants.push_back(std::get<double>(unknown.values.front().value));
  constants.resize(constants.size() + scene.boundary.integrals.size(), 1.0);
  return constants;
}

/// L̃ of L + Σ ν g, and the manifold with it, with the metric and the rate of another.
void put_constrained_laws(const Scene& scene, const std::shared_ptr<const Manifold>& like,
                          Extension& extension) {
  extension.at = [scene, like](const std::vector<double>& values) {
    const SystemTable table = table_at(scene, values);
    const NormalMotion normal =
        normal_motion(like->metric(), like->rate(), static_cast<int>(like->metric().rows()));
    return make_lagrangian(projected(make_constrained(table), normal));
  };
  extension.manifold_at = [scene, like](const std::vector<double>& values) {
    const SystemTable table = table_at(scene, values);
    return constrained_values(make_constrained(table), make_system(table), like->metric(), like->rate());
  };
}

void check_constrained(const Scene& scene, const Problem& problem) {
  if (problem.duration.free && !problem.manifold->autonomous())
    throw SceneError(
        scene.boundary.duration.at,
        "with integrals, unknowns, nonlinear conditions or waypoints and constraints a free duration "
        "needs constraints and a Lagrangian that do not depend on t; give the duration as a number");
  if (!scene.waypoints.empty() && constraints_vary(scene))
    throw SceneError(
        position(scene.system.constraints.front(), 0),
        "constraints that depend on an unknown are not available with waypoints; leave one or the "
        "other out");
}

[[noreturn]] void refuse_unknown(const Assignment& a, const std::string& why) {
  throw SceneError(a.at, fmt::format("'{}' depends on an unknown, {}", a.name, why));
}

/// A momentum that depends on an unknown, as what it adds to the action.
Text momentum_term(const char* place, const Assignment& a, const Scene& scene, const System& system) {
  if (system.hamiltonian) refuse_unknown(a, "which momenta may not in phase space; give a number");
  if (!scene.system.constraints.empty())
    refuse_unknown(a, "which momenta may not where there are constraints; give a number");
  return {fmt::format("{}{}({})*({}) = 0", place[0] == 'T' ? "-" : "", a.name.substr(2), place,
                      *as_formula(a.values.front())),
          a.at};
}

/// The entries of "start" or "end" without those made of unknowns, which become conditions and terms of
/// momenta.
void split_end(const char* place, const Dependents& dependents, const Scene& scene, const System& system,
               std::vector<Assignment>& entries, ExtendedScene& parts) {
  const std::vector<Assignment> all = entries;
  std::erase_if(entries, [&](const Assignment& a) {
    const auto depends = [&](const Quantity& q) {
      return as_formula(q) && any_of(names_in(*as_formula(q)), dependents);
    };
    if (!std::ranges::any_of(a.values, depends)) return false;
    if (a.list) refuse_unknown(a, "which only single coordinates and momenta may; write an entry for each");
    const bool momentum = a.name.starts_with("p_");
    const std::string other = momentum ? a.name.substr(2) : "p_" + a.name;
    if (std::ranges::find(all, other, &Assignment::name) != all.end())
      refuse_unknown(a, fmt::format("and '{}' is given at this end too; leave one of them out", other));
    if (momentum)
      parts.momenta.push_back(momentum_term(place, a, scene, system));
    else
      parts.conditions.push_back(
          {fmt::format("{}({}) = {}", a.name, place, *as_formula(a.values.front())), a.at});
    return true;
  });
}

/// Of families, which are followed from value to value.
void check_extended_family(const Scene& scene, const std::string& asks) {
  const ContinuationTable& table = *scene.continuation;
  const Location at = position(table.parameter, 0);
  if (table.switching) throw SceneError(at, asks + "branch points are not looked for; leave 'switch' out");
  if (!scene.system.constraints.empty())
    throw SceneError(at, asks +
                             "families are not continued under constraints; solve for each value with "
                             "--set instead");
  if (table.parameter.value == "duration" && !scene.waypoints.empty())
    throw SceneError(at, "between waypoints the duration is not varied; vary a parameter");
  if (std::ranges::find(scene.boundary.unknowns, table.parameter.value, &Assignment::name) !=
      scene.boundary.unknowns.end())
    throw SceneError(at, fmt::format("'{}' is an unknown, which the conditions determine; vary another "
                                     "parameter",
                                     table.parameter.value));
}

/// Forces have no action, but the principle of Lagrange and d'Alembert says what conditions and waypoints
/// ask.
void check_extended_forces(const Scene& scene, const std::string& asks) {
  const Location& at = scene.system.force.front().name_at;
  if (!scene.system.constraints.empty())
    throw SceneError(at, asks + "and constraints forces are not available; leave one or the other out");
  if (scene.boundary.periodic && scene.boundary.free)
    throw SceneError(scene.boundary.duration.at,
                     asks + "and forces the period must be given; write a number");
  for (const WaypointTable& waypoint : scene.waypoints)
    if (waypoint.free)
      throw SceneError(waypoint.time.at, "with forces the time of a waypoint must be given; write a number");
}

}  // namespace

ExtendedScene split(const Scene& scene, const System& system, bool extended) {
  ExtendedScene parts;
  parts.linear = scene.boundary;
  const Dependents dependents = dependents_of(scene);
  split_end("0", dependents, scene, system, parts.linear.start, parts);
  split_end("T", dependents, scene, system, parts.linear.end, parts);
  std::erase_if(parts.linear.conditions, [&](const Text& text) {
    const bool contains = any_of(names_in(text.value), dependents);
    const bool linear = !contains && placed(text, [&](const std::string& s) {
                                       return end_equation(s, system, "conditions");
                                     }).affine;
    if (!linear) parts.conditions.push_back(text);
    return !linear;
  });
  parts.extended = extended || !scene.boundary.unknowns.empty() || !scene.boundary.integrals.empty() ||
                   !scene.waypoints.empty() || !parts.conditions.empty();
  if (!parts.extended) return parts;
  parts.where = scene.boundary.where_list;
  if (scene.boundary.where) parts.where.push_back(*scene.boundary.where);
  parts.linear.where.reset();
  const Quantity& duration = scene.boundary.duration;
  const auto refuse = [&](const Quantity& q, const char* name) {
    if (as_formula(q) && any_of(names_in(*as_formula(q)), dependents))
      throw SceneError(q.at, fmt::format("{} depends on an unknown; it must be a number{}", name,
                                         &q == &duration ? ", or \"free\" with one more condition" : ""));
  };
  refuse(duration, "the duration");
  if (scene.boundary.energy) refuse(*scene.boundary.energy, "the energy");
  for (const Assignment& line : scene.boundary.map)
    for (const Quantity& q : line.values) refuse(q, "the map");
  for (const WaypointTable& waypoint : scene.waypoints) {
    refuse(waypoint.time, "the time of a waypoint");
    for (const Assignment& a : waypoint.values)
      for (const Quantity& q : a.values) refuse(q, "a waypoint");
  }
  return parts;
}

void check_extended(const Scene& scene, Purpose purpose) {
  const std::string asks = "with integrals, unknowns, nonlinear conditions or waypoints ";
  if (purpose == Purpose::comparison)
    throw SceneError(scene.boundary.at,
                     asks + "shooting is not available to compare with; write 'solve' instead");
  if (!scene.system.force.empty()) check_extended_forces(scene, asks);
  if (scene.boundary.infinite)
    throw SceneError(scene.boundary.duration.at,
                     asks + "an infinite duration is not available; give a number");
  if (scene.continuation && purpose == Purpose::family) check_extended_family(scene, asks);
  if (scene.solve.method && scene.solve.method->value != "newton")
    throw SceneError(
        position(*scene.solve.method, 0),
        fmt::format("{}method '{}' is not available; leave it out", asks, scene.solve.method->value));
  if (scene.solve.steps)
    throw SceneError(position(*scene.solve.steps, 0), asks + "the steps are equal; leave 'steps' out");
  const std::size_t legs = scene.waypoints.size() + 1;
  if (scene.solve.elements && scene.solve.elements->value < static_cast<double>(legs))
    throw SceneError(scene.solve.elements->at,
                     fmt::format("elements = {}; need at least {}, one for each leg between waypoints",
                                 scene.solve.elements->value, legs));
}

bool may_be_extended(const Scene& scene, Purpose purpose) {
  try {
    check_extended(scene, purpose);
    return true;
  } catch (const SceneError&) {
    return false;
  }
}

std::shared_ptr<const Lagrangian> extended_lagrangian(const Scene& scene) {
  check_integrands(scene);
  return lagrangian_at(scene, first_constants(scene));
}

bool constraints_vary(const Scene& scene) {
  const Dependents dependents = dependents_of(scene);
  return std::ranges::any_of(scene.system.constraints,
                             [&](const Text& text) { return any_of(names_in(text.value), dependents); });
}

void read_extension(const Scene& scene, const ExtendedScene& parts, const System& system,
                    const CompletedEnds& completed, Problem& problem) {
  const Dependents dependents = dependents_of(scene), constants = constants_of(scene, dependents);
  const SystemTable table = extended_table(scene, dependents);
  System host = make_system(without_forces(table));
  const std::size_t most = 2 * system.names.size(), given = problem.boundary.rows + parts.conditions.size();
  if (given > most)
    throw SceneError(parts.conditions.back().at,
                     fmt::format("{} conditions for {} end values; at most {} can hold, so leave some out",
                                 given, most, most));
  if (host.lagrangian->kinks())
    throw SceneError(
        scene.system.law().at,
        "with integrals, unknowns, nonlinear conditions or waypoints L must be smooth; abs, min, max "
        "and step are not available");
  std::optional<ConditionsOnManifold> on_manifold;
  if (problem.manifold) {
    check_constrained(scene, problem);
    const Manifold& manifold = *problem.manifold;
    const ConstrainedGraph graph = make_constrained(table);
    host.lagrangian = make_lagrangian(
        projected(graph, normal_motion(manifold.metric(), manifold.rate(), graph.coordinates)));
    on_manifold.emplace(graph, manifold, problem.duration.value);
  }
  const MovedEnds* const ends = on_manifold ? &on_manifold->ends() : nullptr;
  auto extension = std::make_shared<Extension>();
  extension->lagrangian = host.lagrangian;
  for (const Assignment& unknown : scene.boundary.unknowns) {
    extension->names.push_back(unknown.name);
    extension->guess.push_back(std::get<double>(unknown.values.front().value));
  }
  for (const Text& text : scene.boundary.integrals)
    extension->integrals.push_back(value_of_integral(text, scene, system));
  for (const Text& text : parts.conditions)
    extension->conditions.push_back(condition(text, host, constants, "conditions", ends));
  for (const Text& text : parts.momenta)
    extension->end_terms.push_back(condition(text, host, constants, "end", ends));
  for (const Text& text : parts.where)
    extension->where.push_back(condition(text, host, constants, "where", ends));
  extension->waypoints = read_waypoints(scene, system, problem);
  extension->at = [scene](const std::vector<double>& values) { return lagrangian_at(scene, values); };
  if (problem.copies) {
    extension->copies = make_copies(table, static_cast<int>(extension->names.size()));
    extension->copies_at = [scene](const std::vector<double>& values) {
      return make_copies(table_at(scene, values), 0);
    };
  }
  if (problem.manifold) complete_waypoints(scene, problem, extension->waypoints);
  const bool guessed = problem.guess.given();
  if (!extension->waypoints.empty()) guess_through(*extension, problem);
  if (problem.manifold) {
    if (guessed || extension->waypoints.empty())
      project_guess(scene, completed.near, problem);
    else
      project_lines(scene, guessed_times(extension->waypoints, problem.duration.value), problem);
    put_constrained_laws(scene, problem.manifold, *extension);
    problem.lagrangian = extension->at(first_constants(scene));
    std::vector<std::string> texts;
    for (const Text& text : parts.conditions) texts.push_back(text.value);
    if (!completed.suited) on_manifold->put_relation(texts, problem, *extension);
  }
  problem.extension = std::move(extension);
}

}  // namespace extremal
