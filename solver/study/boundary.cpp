#include "study/boundary.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "study/naming.hpp"

namespace extremal {
namespace {

void fix_ends(const std::vector<Assignment>& values, bool at_end, const System& system,
              PlacedRelation& placed) {
  for (const Assignment& a : values)
    for_each_value(a, range_of(a.name, a.name_at, system), [&](int coordinate, const Quantity& q) {
      placed.relation.fix(coordinate, at_end, evaluate(q, system.parameters));
      placed.rows.push_back(q.at);
    });
}

void add_condition(const Text& text, const System& system, PlacedRelation& relation) {
  const EndEquation equation =
      placed(text, [&](const std::string& s) { return end_equation(s, system, "conditions"); });
  if (!equation.affine)
    throw SceneError(position(text, 0),
                     "a condition must be linear in the end values; use 'where' for one that is not");
  const int row = relation.relation.add_row(-equation.constant);
  for (const Triplet& entry : equation.coefficients) relation.relation.add(row, entry.column, entry.value);
  relation.rows.push_back(position(text, 0));
}

void add_closure(const BoundaryTable& boundary, const System& system, PlacedRelation& placed) {
  const Closure closure = read_closure(boundary, system);
  const int n = placed.relation.coordinates;
  for (int a = 0; a < n; ++a) {
    const int row = placed.relation.add_row(closure[a].constant);
    placed.relation.add(row, n + a, 1.0);
    for (const Triplet& entry : closure[a].coefficients) placed.relation.add(row, entry.column, -entry.value);
    placed.rows.push_back(boundary.at);
  }
}

/// What a line of the map says of one coordinate.
AffineForm read_form(const Quantity& value, const System& system) {
  if (!value.formula()) return {{}, std::get<double>(value.value)};
  const Text text{std::get<std::string>(value.value), value.at};
  return placed(text, [&](const std::string& s) { return affine_form(s, system, "map"); });
}

}  // namespace

Closure read_closure(const BoundaryTable& boundary, const System& system) {
  Closure closure(system.names.size());
  for (std::size_t a = 0; a < closure.size(); ++a) closure[a].coefficients = {{0, static_cast<int>(a), 1.0}};
  for (const Assignment& line : boundary.map)
    for_each_value(line, range_of(line.name, line.name_at, system),
                   [&](int a, const Quantity& value) { closure[a] = read_form(value, system); });
  return closure;
}

PlacedRelation read_relation(const BoundaryTable& boundary, const System& system) {
  PlacedRelation placed;
  placed.relation.coordinates = static_cast<int>(system.names.size());
  if (boundary.periodic) {
    add_closure(boundary, system, placed);
    return placed;
  }
  fix_ends(boundary.start, false, system, placed);
  fix_ends(boundary.end, true, system, placed);
  for (const Text& condition : boundary.conditions) add_condition(condition, system, placed);
  return placed;
}

void set_relation(const BoundaryTable& boundary, const System& system, Problem& problem) {
  PlacedRelation placed = read_relation(boundary, system);
  try {
    problem.ends = solve_relation(placed.relation);
    problem.boundary = std::move(placed.relation);
  } catch (const RelationError& e) {
    throw SceneError(placed.rows[e.row],
                     e.contradiction ? "this condition contradicts the ones before it"
                                     : "this condition follows from the ones before it; leave it out");
  } catch (const std::invalid_argument& e) {
    throw SceneError(boundary.at, e.what());
  }
}

Duration read_duration(const BoundaryTable& boundary, const System& system) {
  Duration duration;
  duration.free = boundary.free;
  if (!boundary.free) {
    duration.value = evaluate(boundary.duration, system.parameters);
    if (!(duration.value > 0))
      throw SceneError(boundary.duration.at,
                       fmt::format("duration = {}; it must be positive", duration.value));
    return duration;
  }
  if (!system.lagrangian->structure().autonomous)
    throw SceneError(boundary.duration.at, "a free duration needs a Lagrangian that does not depend on t");
  if (boundary.energy) duration.energy = evaluate(*boundary.energy, system.parameters);
  if (boundary.where)
    duration.where = placed(*boundary.where, [&](const std::string& s) {
                       return end_equation(s, system, "where");
                     }).function;
  return duration;
}

}  // namespace extremal
