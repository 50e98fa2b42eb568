#include "system/formula_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "system/formula_number.hpp"

namespace extremal::formula {

namespace {

constexpr std::array all_functions{
    Function{"sin", Op::sin},     Function{"cos", Op::cos},   Function{"tan", Op::tan},
    Function{"asin", Op::asin},   Function{"acos", Op::acos}, Function{"atan", Op::atan},
    Function{"atan2", Op::atan2}, Function{"sinh", Op::sinh}, Function{"cosh", Op::cosh},
    Function{"tanh", Op::tanh},   Function{"exp", Op::exp},   Function{"log", Op::log},
    Function{"sqrt", Op::sqrt},   Function{"abs", Op::abs},   Function{"min", Op::min},
    Function{"max", Op::max},     Function{"step", Op::step},
};

constexpr int most_elements = 1'000'000;

const char* description(const Known& known) {
  if (known.meaning == Meaning::coordinate) return known.momentum ? "a momentum" : "a coordinate";
  return known.meaning == Meaning::definition ? "a definition" : "a parameter";
}

/// What the language itself means by a name, or null.
const char* reserved(const std::string& name, Meaning wanted) {
  if (name == "sum" || find_function(name)) return "a function";
  if (name == "t") return "the time";
  if (name == "pi") return "a constant of the language";
  // A definition is not seen where T is the duration: kinetic energies may be called so.
  return name == "T" && wanted != Meaning::definition ? "the duration" : nullptr;
}

void check_value(const std::string& name, const ParameterText& text, const std::string& where) {
  if (!text.list && text.value.size() != 1)
    throw FormulaError(fmt::format("the parameter '{}' has {} numbers; it is one number, or a list", name,
                                   text.value.size()),
                       where, 0);
  for (const double value : text.value)
    if (!std::isfinite(value))
      throw FormulaError(fmt::format("the parameter '{}' is {}; it must be finite", name, value), where, 0);
}

/// "x", "x[32]", "x[2*n]".
void declare_coordinate(Names& names, const SystemText& system, std::size_t k) {
  const std::string &text = system.coordinates[k], where = fmt::format("coordinates[{}]", k);
  Formula formula = parse(text, where);
  const Syntax root = formula.nodes[formula.root];
  if (root.form != Form::reference || root.velocity)
    fail(formula, 0, fmt::format("'{}' does not declare a coordinate; write x, or x[32] for an array", text));
  Coordinate coordinate{std::string(formula.name(root)), names.elements, 1, root.indexed};
  if (root.indexed) {
    formula.root = formula.children(root)[0].node;
    Names constants;
    constants.declare(system.parameters, system.active, system.replaceable);
    for (const Coordinate& earlier : names.coordinates) constants.declare(earlier, where);
    constants.declare(system.definitions);
    std::vector<double> indices = resolve_at(formula, constants, 0);
    const long count = Evaluator(constants).integer(formula, formula.root, indices, "the size of an array");
    if (count < 1)
      fail(formula, 0, fmt::format("'{}' would have {} elements; need at least 1", coordinate.name, count));
    if (count > most_elements - names.elements)
      fail(formula, 0,
           fmt::format("'{}' has {} elements after {}; {} are the most in all", coordinate.name, count,
                       names.elements, most_elements));
    coordinate.count = static_cast<int>(count);
  }
  names.declare(coordinate, where);
}

}  // namespace

std::span<const Function> functions() { return all_functions; }

const Function* find_function(std::string_view name) {
  const auto it = std::find_if(all_functions.begin(), all_functions.end(),
                               [&](const Function& function) { return function.name == name; });
  return it == all_functions.end() ? nullptr : &*it;
}

const Known* Names::find(std::string_view name) const {
  const auto it = table.find(name);
  return it == table.end() ? nullptr : &it->second;
}

void Names::declare(const std::string& name, Known known, const std::string& where) {
  const char* what = description(known);
  if (!is_name(name))
    throw FormulaError(fmt::format("'{}' is not a name: it takes letters, digits and _, and no digit first",
                                   name.substr(0, 40)),
                       where, 0);
  if (const char* meaning = reserved(name, known.meaning))
    throw FormulaError(fmt::format("'{}' is {}; choose another name for {}", name, meaning, what), where, 0);
  if (const auto [it, added] = table.try_emplace(name, known); !added)
    throw FormulaError(
        fmt::format("'{}' is {} already; choose another name for {}", name, description(it->second), what),
        where, 0);
}

void Names::declare(const Coordinate& coordinate, const std::string& where) {
  if (elements + coordinate.count > most_elements)
    throw FormulaError(fmt::format("more than {} coordinates", most_elements), where, 0);
  declare(coordinate.name,
          {Meaning::coordinate, static_cast<int>(coordinates.size()), coordinate.count, coordinate.array},
          where);
  coordinates.push_back(coordinate);
  elements += coordinate.count;
}

void Names::declare_momenta() {
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    const Coordinate& c = coordinates[k];
    declare("p_" + c.name, {Meaning::coordinate, static_cast<int>(k), c.count, c.array, true},
            fmt::format("coordinates[{}]", k));
  }
}

void Names::declare(const std::map<std::string, std::string>& texts) {
  for (const auto& [name, text] : texts) {
    const std::string where = "definitions." + name;
    declare(name, {Meaning::definition, static_cast<int>(definitions.size())}, where);
    definitions.push_back({.where = where, .text = text});
  }
}

void Names::declare(const std::map<std::string, ParameterText>& texts, std::span<const std::string> symbolic,
                    bool to_replace) {
  replaceable = to_replace;
  for (std::size_t k = 0; k < symbolic.size(); ++k) {
    const std::string& name = symbolic[k];
    const std::string where = fmt::format("active[{}]", k);
    const auto it = texts.find(name);
    if (it == texts.end()) throw FormulaError(fmt::format("there is no parameter '{}'", name), where, 0);
    const auto& [value, list] = it->second;
    if (list && !replaceable)
      throw FormulaError(fmt::format("'{}' is a list; only single parameters can be active", name), where, 0);
    check_value(name, it->second, "parameters." + name);
    declare(name, {Meaning::active, static_cast<int>(active.size()), static_cast<int>(value.size()), list},
            where);
    active.insert(active.end(), value.begin(), value.end());
  }
  for (const auto& [name, text] : texts) {
    if (find(name) != nullptr && find(name)->meaning == Meaning::active) continue;
    check_value(name, text, "parameters." + name);
    const int id = static_cast<int>(parameters.size()), count = static_cast<int>(text.value.size());
    declare(name, {Meaning::parameter, id, count, text.list}, "parameters." + name);
    parameters.push_back(&text.value);
  }
}

Names names_of(const SystemText& text) {
  Names names;
  names.declare(text.parameters, text.active, text.replaceable);
  for (std::size_t k = 0; k < text.coordinates.size(); ++k) declare_coordinate(names, text, k);
  if (names.elements == 0) throw FormulaError("no coordinates; need at least 1", "coordinates", 0);
  names.kind = text.hamiltonian ? Kind::hamiltonian : Kind::lagrangian;
  if (names.kind == Kind::hamiltonian) names.declare_momenta();
  names.declare(text.definitions);
  parse_definitions(names);
  return names;
}

Names names_of(Kind kind, const Vocabulary& vocabulary) {
  Names names;
  names.kind = kind;
  names.declare(vocabulary.parameters, {});
  for (const Coordinate& coordinate : vocabulary.coordinates) names.declare(coordinate, "coordinates");
  names.declare(vocabulary.definitions);
  return names;
}

}  // namespace extremal::formula
