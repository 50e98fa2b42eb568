#include "system/formula_mend.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

namespace extremal::formula {

namespace {

/// A name that is unknown, and what is known where it stands.
struct Unknown {
  const std::string& name;
  bool call;
  const Names& names;
  Kind kind;
  std::span<const std::string> indices;

  bool of_ends() const { return kind == Kind::condition || kind == Kind::quantity; }

  /// With an argument, functions and end values; without, all but functions.
  std::vector<std::string> names_that_stand() const {
    std::vector<std::string> known;
    if (call) {
      known.emplace_back("sum");
      for (const Function& function : functions()) known.emplace_back(function.name);
    } else {
      known.assign(indices.begin(), indices.end());
      known.emplace_back("pi");
    }
    for (const auto& [other, meaning] : names.table)
      if (!call || of_ends()) known.push_back(other);
    return known;
  }

  bool is_number(const std::string& part) const {
    const Known* known = names.find(part);
    if (known != nullptr && known->meaning == Meaning::coordinate && !in_motion(kind) && kind != Kind::map)
      return false;
    if (known != nullptr) return !known->array;
    if (part == "t") return in_motion(kind) || kind == Kind::guess;
    return part == "pi" || std::ranges::find(indices, part) != indices.end();
  }

  /// "k*x" for kx.
  std::string product() const {
    for (std::size_t k = 1; !call && k < name.size(); ++k)
      if (is_number(name.substr(0, k)) && is_number(name.substr(k)))
        return fmt::format("{}*{}", name.substr(0, k), name.substr(k));
    return {};
  }

  std::string nearest() const {
    const std::string factors = product();
    return factors.empty() ? nearest_name(name, names_that_stand()) : factors;
  }

  /// The names of parameters, if they are few.
  std::string declared_parameters() const {
    constexpr std::size_t few = 8;
    std::vector<std::string> declared;
    for (const auto& [other, known] : names.table)
      if (known.meaning == Meaning::parameter || known.meaning == Meaning::active) declared.push_back(other);
    if (declared.empty() || declared.size() > few) return {};
    return fmt::format(" Declared: {}", fmt::join(declared, ", "));
  }

  /// For p_x where it does not stand for a momentum, and p_y where there is no y.
  std::string momentum() const {
    if (!name.starts_with("p_") || names.coordinates.empty()) return {};
    const Coordinate& first = names.coordinates.front();
    const Known* known = names.find(name.substr(2));
    if (known != nullptr && known->meaning == Meaning::coordinate && kind == Kind::lagrangian)
      return fmt::format("; momenta stand in a hamiltonian; here are velocities: {}'",
                         spelled(name.substr(2), known->array));
    if (kind != Kind::hamiltonian) return {};
    return fmt::format("; there is no coordinate '{}'; momenta are those of coordinates: {}", name.substr(2),
                       momentum_of(first.name, first.array));
  }

  /// For p_x(0) and p_x(T).
  std::string end_momentum() const {
    if (!name.starts_with("p_")) return {};
    const Known* known = names.find(name.substr(2));
    if (known == nullptr || known->meaning != Meaning::coordinate) return {};
    return fmt::format(
        "; conditions hold between coordinates, and a momentum is given at its end: start = {{ "
        "{0} = … }} or end = {{ {0} = … }}",
        name);
  }

  /// For dx/dt, x_dot, v_x, diff(x, t) and the like.
  std::string velocity() const {
    constexpr std::array derivatives{"diff", "dot", "ddt", "der", "deriv", "derivative", "D", "d"};
    std::string coordinate = velocity_meant(name, names.coordinates);
    const bool other = call ? std::ranges::find(derivatives, name) != derivatives.end() : name == "dt";
    if (other && !names.coordinates.empty()) coordinate = names.coordinates.front().name;
    if (coordinate.empty()) return {};
    return fmt::format("; velocities are written {}'", spelled(coordinate, names.find(coordinate)->array));
  }
};

}  // namespace

std::string spelled(const std::string& name, bool array) { return array ? name + "[1]" : name; }

std::string momentum_of(const std::string& coordinate, bool array) {
  return "p_" + spelled(coordinate, array);
}

std::string mend_of_unknown(const std::string& name, bool call, const Names& names, Kind kind,
                            std::span<const std::string> indices) {
  const Unknown unknown{name, call, names, kind, indices};
  if (name == "t") return "; the time cannot stand here";
  if (name == "T") return "; T is the duration only in a guess, and in x(T) in a condition";
  if (call && kind == Kind::condition && !unknown.end_momentum().empty()) return unknown.end_momentum();
  if (kind != Kind::guess && !call && !unknown.momentum().empty()) return unknown.momentum();
  if (kind == Kind::lagrangian && !unknown.velocity().empty()) return unknown.velocity();
  if (const std::string nearest = unknown.nearest(); !nearest.empty())
    return fmt::format("; did you mean '{}'?", nearest);
  if (!call) return "; is it a parameter that is not declared?" + unknown.declared_parameters();
  std::string known = "; known are sum";
  for (const Function& function : functions()) known += fmt::format(" {}", function.name);
  return known;
}

}  // namespace extremal::formula
