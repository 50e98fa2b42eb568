#include "system/formula_mend.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

namespace extremal::formula {

namespace {

/// A function of other languages, and what has its values here.
struct Foreign {
  std::string_view names, written;
};

constexpr Foreign foreign_functions[] = {
    {"ln", "log(u)"},
    {"lg log10", "log(u)/log(10)"},
    {"lb log2", "log(u)/log(2)"},
    {"pow power", "u^v"},
    {"square", "u^2"},
    {"cbrt", "u^(1/3)"},
    {"hypot norm", "sqrt(u^2 + v^2)"},
    {"fabs", "abs(u)"},
    {"tg", "tan(u)"},
    {"cot ctg cotan", "1/tan(u)"},
    {"sec", "1/cos(u)"},
    {"csc cosec", "1/sin(u)"},
    {"coth", "1/tanh(u)"},
    {"sech", "1/cosh(u)"},
    {"csch", "1/sinh(u)"},
    {"asinh arsinh arcsinh", "log(u + sqrt(u^2 + 1))"},
    {"acosh arcosh arccosh", "log(u + sqrt(u^2 - 1))"},
    {"atanh artanh arctanh", "log((1 + u)/(1 - u))/2"},
    {"expm1", "exp(u) - 1"},
    {"log1p", "log(1 + u)"},
    {"sinc", "sin(u)/u"},
    {"heaviside Heaviside", "step(u)"},
};

/// For sgn(u), pow(u, v) and the like.
std::string foreign(std::string_view name) {
  if (name == "sgn" || name == "sign" || name == "signum")
    return fmt::format(
        "; {0}(u)*u is written abs(u), {0}(u) in a force u/abs(u), and of t and parameters 2*step(u) - 1",
        name);
  for (const Foreign& function : foreign_functions) {
    for (std::string_view rest = function.names; !rest.empty();) {
      const std::string_view one = rest.substr(0, rest.find(' '));
      rest.remove_prefix(std::min(one.size() + 1, rest.size()));
      if (one != name) continue;
      const bool two = function.written.find('v') != std::string_view::npos;
      return fmt::format("; {}({}) is written {}", name, two ? "u, v" : "u", function.written);
    }
  }
  return {};
}

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
    if (names.coordinates.empty()) return {};
    const Coordinate& first = names.coordinates.front();
    if (kind == Kind::hamiltonian && name == "p")
      return fmt::format("; momenta are those of coordinates: {}", momentum_of(first.name, first.array));
    for (const Coordinate& c : names.coordinates)
      if (kind == Kind::hamiltonian && name == "p" + c.name)
        return fmt::format("; momenta are written {}", momentum_of(c.name, c.array));
    if (!name.starts_with("p_")) return {};
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
    if (!of_ends() || !name.starts_with("p_")) return {};
    const Known* known = names.find(name.substr(2));
    if (known == nullptr || known->meaning != Meaning::coordinate) return {};
    if (kind == Kind::quantity)
      return fmt::format("; of a point there are coordinates and velocities: {0}(0), {0}'(0)",
                         spelled(name.substr(2), known->array));
    return fmt::format(
        "; conditions hold between coordinates; a momentum is given in 'start' or 'end': start = {{ {} = … "
        "}}",
        name);
  }

  /// For z(0), where there is no z.
  std::string end_values() const {
    constexpr std::size_t few = 8;
    if (!of_ends()) return {};
    std::vector<std::string> values;
    for (const Coordinate& c : names.coordinates) values.push_back(spelled(c.name, c.array) + "(0)");
    if (values.size() > few) values.resize(few);
    return fmt::format("; end values are {}", fmt::join(values, ", "));
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
  if (name == "free" && kind == Kind::number) return "; a coordinate that is free is left out";
  if (name == "T") return "; T is the duration only in a guess, and in x(T) in a condition";
  if (call && !unknown.end_momentum().empty()) return unknown.end_momentum();
  if (call && !foreign(name).empty()) return foreign(name);
  if (name == "e" && !call) return "; exp(u) is written for e^u";
  if (kind != Kind::guess && !call && !unknown.momentum().empty()) return unknown.momentum();
  if (kind == Kind::lagrangian && !unknown.velocity().empty()) return unknown.velocity();
  if (const std::string nearest = unknown.nearest(); !nearest.empty())
    return fmt::format("; did you mean '{}'?", nearest);
  if (!call) return "; is it a parameter that is not declared?" + unknown.declared_parameters();
  std::string known = unknown.end_values() + (unknown.of_ends() ? "; functions are sum" : "; known are sum");
  for (const Function& function : functions()) known += fmt::format(" {}", function.name);
  return known;
}

}  // namespace extremal::formula
