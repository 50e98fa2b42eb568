#include "study/model/boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "linear/dense.hpp"
#include "scene/schema.hpp"
#include "study/model/naming.hpp"

namespace extremal {
namespace {

/// What an end is given for one coordinate.
struct EndEntry {
  const Quantity *value = nullptr, *momentum = nullptr;
  int index = 0;  ///< of the coordinate in its array
};
using EndEntries = std::vector<EndEntry>;

bool is_coordinate(const std::string& name, const System& system) {
  const std::string stem = name.substr(0, name.find('['));
  return std::ranges::any_of(system.coordinates, [&](const Coordinate& c) { return c.name == stem; });
}

/// Sets an entry. One of --set for an element takes the place of that of its array.
void put(const Quantity*& entry, const Quantity& given, const std::string& name) {
  if (entry && given.at.source && given.at.source->numbered)
    throw SceneError(given.at,
                     fmt::format("'{}' is given by its whole array already; leave one of them out", name));
  entry = &given;
}

/// "start" or "end" coordinate by coordinate.
EndEntries read_entries(const std::vector<Assignment>& table, const char* end, const System& system) {
  EndEntries entries(system.names.size());
  for (const bool whole : {true, false})
    for (const Assignment& a : table) {
      if (a.name.ends_with('\''))
        throw SceneError(
            a.name_at, fmt::format("\"{0}\" is a velocity, and '{1}' holds coordinates and momenta (p_{2} = "
                                   "∂L/∂{0}); give p_{2} here or, for a motion as guess, "
                                   "state = {{ \"{0}\" = … }} in [guess]",
                                   a.name, end, a.name.substr(0, a.name.size() - 1)));
      const bool momentum = a.name.starts_with("p_") && !is_coordinate(a.name, system);
      const Range range = range_of(momentum ? a.name.substr(2) : a.name, a.name_at, system);
      if (range.array != whole) continue;
      for_each_value(a, range, [&](int coordinate, const Quantity& q, int index) {
        EndEntry& entry = entries[coordinate];
        put(momentum ? entry.momentum : entry.value, q, a.name);
        entry.index = index;
      });
    }
  return entries;
}

/// In phase space momenta are coordinates: those that are given stand beside what is given of q.
EndEntries with_momenta(const EndEntries& entries) {
  const std::size_t n = entries.size() / 2;
  EndEntries result(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(n));
  for (std::size_t a = 0; a < n; ++a) result[a].momentum = entries[n + a].value;
  for (std::size_t a = 0; a < n; ++a)
    if (result[a].momentum) result[a].index = entries[n + a].index;
  return result;
}

bool has_both(const EndEntry& e) { return e.value && e.momentum; }

/// Every coordinate and every momentum at the start, which determine the motion.
bool are_initial_data(const EndEntries& start, const EndEntries& end, const System& system) {
  if (!std::ranges::all_of(start, has_both)) return false;
  for (std::size_t a = 0; a < end.size(); ++a)
    if (const Quantity* given = end[a].value ? end[a].value : end[a].momentum)
      throw SceneError(
          given->at,
          fmt::format("'start' gives every coordinate and every momentum: these initial data determine the "
                      "motion, and nothing can be given of '{}' at the end; leave 'end' out, or give at the "
                      "start either the coordinates or the momenta",
                      system.names[a]));
  return true;
}

/// At each end a coordinate or its momentum can be given.
void check_entries(const EndEntries& start, const EndEntries& end, const System& system) {
  for (const EndEntries* entries : {&start, &end})
    if (const auto twice = std::ranges::find_if(*entries, has_both); twice != entries->end()) {
      const std::string& name = system.names[twice - entries->begin()];
      std::string mend = "leave one of them out, it follows";
      if (const auto lacks = std::ranges::find_if_not(start, has_both); entries == &start)
        mend +=
            fmt::format("; for initial data the start needs both of every coordinate, and '{}{}' is missing",
                        lacks->value ? "p_" : "", system.names[lacks - start.begin()]);
      throw SceneError(twice->momentum->at,
                       fmt::format("'{0}' and 'p_{0}' are both given at this end; {1}", name, mend));
    }
}

void fix_end(const EndEntries& entries, bool at_end, const System& system, PlacedRelation& placed) {
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const EndEntry& entry = entries[k];
    const int coordinate = static_cast<int>(k);
    if (entry.value) {
      placed.relation.fix(coordinate, at_end, evaluate(*entry.value, system, entry.index));
      placed.rows.push_back(entry.value->at);
    }
    if (!entry.momentum) continue;
    const double momentum = evaluate(*entry.momentum, system, entry.index);
    placed.relation.give_momentum(coordinate, at_end, momentum);
    if (system.hamiltonian) {
      placed.relation.fix(static_cast<int>(entries.size() + k), at_end, momentum);
      placed.rows.push_back(entry.momentum->at);
      continue;
    }
    placed.momentum_given.resize(2 * entries.size());
    placed.momentum_given[at_end ? entries.size() + k : k] = true;
  }
}

void read_initial_data(const EndEntries& start, const System& system, PlacedRelation& placed) {
  placed.initial.emplace();
  for (std::size_t k = 0; k < start.size(); ++k) {
    const EndEntry& entry = start[k];
    placed.initial->q.push_back(evaluate(*entry.value, system, entry.index));
    placed.initial->p.push_back(evaluate(*entry.momentum, system, entry.index));
    placed.relation.fix(static_cast<int>(k), false, placed.initial->q.back());
    placed.rows.push_back(entry.value->at);
  }
  if (!system.hamiltonian) return;
  // The coordinates are (q, p), and their momenta (p, 0).
  InitialData& data = *placed.initial;
  for (std::size_t k = 0; k < start.size(); ++k) {
    placed.relation.fix(static_cast<int>(start.size() + k), false, data.p[k]);
    placed.rows.push_back(start[k].momentum->at);
  }
  data.q.insert(data.q.end(), data.p.begin(), data.p.end());
  data.p.resize(data.q.size());
}

void add_condition(const Text& text, const System& system, PlacedRelation& relation) {
  const EndEquation equation =
      placed(text, [&](const std::string& s) { return end_equation(s, system, "conditions"); });
  if (!equation.affine)  // at another value of a parameter
    throw SceneError(position(text, 0),
                     "a condition that is linear in the end values must stay so along a family");
  const auto momenta = static_cast<int>(system.names.size() / 2);
  for (const Triplet& entry : equation.coefficients)
    if (system.hamiltonian && entry.column % (2 * momenta) >= momenta)
      throw SceneError(position(text, 0),
                       "conditions relate coordinates; momenta are given by 'start' and 'end' alone");
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
AffineForm read_form(const Quantity& value, const System& system, int index) {
  if (!value.formula()) return {{}, std::get<double>(value.value)};
  const Text text{std::get<std::string>(value.value), value.at};
  return placed(text, [&](const std::string& s) { return affine_form(s, system, "map", index); });
}

/// p(T) = R⁻ᵀ p(0) where q(T) = R q(0) + c and the map names no momentum.
void close_momenta(const BoundaryTable& boundary, const System& system, Closure& closure) {
  const auto n = static_cast<int>(closure.size() / 2);
  for (const Assignment& line : boundary.map)
    if (range_of(line.name, line.name_at, system).first >= n) return;
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(n, n);
  for (int a = 0; a < n; ++a)
    for (const Triplet& entry : closure[a].coefficients) {
      if (entry.column >= n)
        throw SceneError(
            boundary.map.front().name_at,
            "the map takes momenta to coordinates; write what becomes of the momenta as well, as "
            "p_x = \"-x\"");
      map(a, entry.column) += entry.value;
    }
  if (map.isIdentity(0)) return;
  const Eigen::MatrixXd inverse = solved(map.transpose(), Eigen::MatrixXd::Identity(n, n));
  if (!inverse.allFinite())
    throw SceneError(boundary.map.front().name_at, "the map is singular; it must be invertible");
  for (int a = 0; a < n; ++a) {
    closure[n + a] = {};
    for (int b = 0; b < n; ++b)
      if (inverse(a, b) != 0) closure[n + a].coefficients.push_back({0, n + b, inverse(a, b)});
  }
}

}  // namespace

bool maps_momenta(const BoundaryTable& boundary, const System& system) {
  const auto named = [&](const std::string& name) { return is_momentum(name, system); };
  return std::ranges::any_of(boundary.map, [&](const Assignment& line) {
    return named(line.name) || std::ranges::any_of(line.values, [&](const Quantity& value) {
             return value.formula() &&
                    std::ranges::any_of(names_in(std::get<std::string>(value.value)), named);
           });
  });
}

Closure read_closure(const BoundaryTable& boundary, const System& system) {
  Closure closure(system.names.size());
  for (std::size_t a = 0; a < closure.size(); ++a) closure[a].coefficients = {{0, static_cast<int>(a), 1.0}};
  for (const Assignment& line : boundary.map)
    for_each_value(
        line, range_of(line.name, line.name_at, system),
        [&](int a, const Quantity& value, int index) { closure[a] = read_form(value, system, index); });
  if (system.hamiltonian) close_momenta(boundary, system, closure);
  return closure;
}

PlacedRelation read_relation(const BoundaryTable& boundary, const System& system) {
  PlacedRelation placed;
  placed.relation.coordinates = static_cast<int>(system.names.size());
  if (boundary.periodic) {
    add_closure(boundary, system, placed);
    return placed;
  }
  EndEntries start = read_entries(boundary.start, "start", system),
             end = read_entries(boundary.end, "end", system);
  if (system.hamiltonian) {
    start = with_momenta(start);
    end = with_momenta(end);
  }
  if (are_initial_data(start, end, system)) {
    read_initial_data(start, system, placed);
    return placed;
  }
  check_entries(start, end, system);
  fix_end(start, false, system, placed);
  fix_end(end, true, system, placed);
  for (const Text& condition : boundary.conditions) add_condition(condition, system, placed);
  return placed;
}

void set_relation(const BoundaryTable& boundary, const System& system, Problem& problem) {
  PlacedRelation placed = read_relation(boundary, system);
  try {
    problem.ends = solve_relation(placed.relation);
    problem.boundary = std::move(placed.relation);
    problem.initial = std::move(placed.initial);
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
  if (boundary.infinite) return duration;
  if (!boundary.free) {
    duration.value = evaluate_beside(choices_of("boundary", "duration"), boundary.duration, system);
    if (!(duration.value > 0))
      throw SceneError(boundary.duration.at,
                       fmt::format("duration = {}; it must be positive", duration.value));
    return duration;
  }
  if (!(system.copies ? system.copies : system.lagrangian)->structure().autonomous)
    throw SceneError(boundary.duration.at,
                     fmt::format("a free duration needs a Lagrangian that does not depend on t{}",
                                 system.copies ? ", and forces that do not" : ""));
  if (boundary.energy) duration.energy = evaluate(*boundary.energy, system);
  if (boundary.where)
    duration.where = placed(*boundary.where, [&](const std::string& s) {
                       return end_equation(s, system, "where");
                     }).function;
  return duration;
}

}  // namespace extremal
