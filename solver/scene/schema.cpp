#include "scene/schema.hpp"

#include <algorithm>
#include <iterator>

namespace extremal {
namespace {

constexpr KeyRecord keys[] = {
    {"", "title", Kind::text},
    {"", "system", Kind::table},
    {"", "boundary", Kind::table},
    {"", "guess", Kind::table},
    {"", "solve", Kind::table},
    {"", "path", Kind::table, false, false},
    {"", "search", Kind::table},
    {"", "continuation", Kind::table},
    {"", "fit", Kind::table, false, false},

    {"system", "use", Kind::text},
    {"system", "coordinates", Kind::texts},
    {"system", "parameters", Kind::numbers, true},
    {"system", "definitions", Kind::text, true},
    {"system", "lagrangian", Kind::text},
    {"system", "curvature", Kind::number},
    {"system", "hamiltonian", Kind::text, false, false},
    {"system", "constraints", Kind::texts, false, false},
    {"system", "force", Kind::text, true, false},

    {"boundary", "start", Kind::quantities, true},
    {"boundary", "end", Kind::quantities, true},
    {"boundary", "duration", Kind::quantity},
    {"boundary", "energy", Kind::quantity},
    {"boundary", "where", Kind::text},
    {"boundary", "periodic", Kind::boolean},
    {"boundary", "map", Kind::quantities, true},
    {"boundary", "conditions", Kind::texts},

    {"guess", "file", Kind::text},
    {"guess", "state", Kind::quantities, true},
    {"guess", "duration", Kind::quantity},
    {"guess", "*", Kind::quantities},

    {"solve", "tolerance", Kind::number},
    {"solve", "scheme", Kind::text},
    {"solve", "elements", Kind::integer},
    {"solve", "method", Kind::text},

    {"search", "solutions", Kind::integer},

    {"continuation", "parameter", Kind::text},
    {"continuation", "to", Kind::number},
    {"continuation", "points", Kind::integer},
    {"continuation", "switch", Kind::boolean},

    {"system file", "about", Kind::note, true},
    {"system file", "system", Kind::table},
};

constexpr Exclusion pairs[] = {
    {"solve.tolerance", "solve.elements", "'elements' fixes the discretisation and with it the error"},
    {"system.use", "system.coordinates", "the system file declares the coordinates"},
    {"boundary.periodic", "boundary.start", "a periodic orbit has no fixed ends; 'where' selects it"},
    {"boundary.periodic", "boundary.end", "a periodic orbit has no fixed ends; 'where' selects it"},
    {"boundary.periodic", "boundary.conditions", "both relate the ends"},
    {"boundary.conditions", "boundary.start", "write the fixed ends as conditions too"},
    {"boundary.conditions", "boundary.end", "write the fixed ends as conditions too"},
    {"boundary.energy", "boundary.where", "exactly one of them closes a free duration"},
    {"guess.file", "guess.state", "a guess has one source"},
    {"guess.file", "guess.*", "a guess has one source"},
    {"guess.state", "guess.*", "a guess has one source"},
};

constexpr Requirement needs[] = {
    {"solve.elements", "solve.scheme", "the number of elements alone does not fix a discretisation"},
    {"boundary.map", "boundary.periodic", "a map relates the ends of a periodic orbit"},
};

constexpr MethodRecord methods[] = {
    {"newton", "damped Newton method; elements and degree rise until the tolerance is met"},
    {"ceres", "least squares of the residual by Ceres, then Newton's method"},
    {"ipopt", "interior point method of Ipopt with the equations as constraints, then Newton's method"},
};

}  // namespace

const char* description(Kind kind) {
  switch (kind) {
    case Kind::text:
      return "a string";
    case Kind::number:
      return "a number";
    case Kind::integer:
      return "an integer";
    case Kind::boolean:
      return "true or false";
    case Kind::quantity:
      return "a number or a formula";
    case Kind::texts:
      return "a list of strings";
    case Kind::numbers:
      return "a number or a list of numbers";
    case Kind::quantities:
      return "a number, a formula or a list of them";
    case Kind::note:
      return "a string or a list of strings";
    case Kind::table:
      break;
  }
  return "a table";
}

std::span<const Exclusion> exclusions() { return pairs; }
std::span<const Requirement> requirements() { return needs; }
std::span<const MethodRecord> method_records() { return methods; }

const KeyRecord* find_key(std::string_view table, std::string_view key) {
  const auto is = [&](std::string_view wanted) {
    return std::find_if(std::begin(keys), std::end(keys),
                        [&](const KeyRecord& k) { return k.table == table && k.key == wanted; });
  };
  const KeyRecord* found = is(key);
  if (found == std::end(keys)) found = is("*");
  return found == std::end(keys) ? nullptr : found;
}

std::vector<std::string> keys_of(std::string_view table) {
  std::vector<std::string> names;
  for (const KeyRecord& k : keys)
    if (k.table == table && k.key != "*") names.emplace_back(k.key);
  return names;
}

}  // namespace extremal
