#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "system/formula_syntax.hpp"

/// \file The names that a formula may use, and what they stand for.

namespace extremal::formula {

/// A function of the language; min, max and atan2 take two arguments. step(u) is Op::step of u and 0.
struct Function {
  std::string_view name;
  Op op;
  int arguments() const { return op == Op::step ? 1 : arity(op); }
};
std::span<const Function> functions();
const Function* find_function(std::string_view name);  ///< or null

/// What a kind of formula may use beside parameters and pi, itself or by definitions.
enum class Kind {
  number,       ///< nothing
  guess,        ///< t, T
  map,          ///< coordinates
  condition,    ///< end values x(0), x(T)
  quantity,     ///< end values x(0), x'(T)
  lagrangian,   ///< coordinates, velocities, t; so are definitions
  hamiltonian,  ///< coordinates, momenta, t; so are definitions, where a Hamiltonian is written
};

/// Whether the formula is read along a motion.
inline bool in_motion(Kind kind) { return kind == Kind::lagrangian || kind == Kind::hamiltonian; }

/// What a declared name is.
struct Known {
  Meaning meaning = Meaning::none;
  int id = 0;
  int count = 1;  ///< elements of an array or list
  bool array = false;
  bool momentum = false;  ///< of the coordinate with this id
};

struct Names {
  Kind kind = Kind::number;
  std::vector<Coordinate> coordinates;
  int elements = 0;                          ///< of all coordinates together
  std::vector<const Parameter*> parameters;  ///< by Known::id; those of the vocabulary, which outlives this
  std::vector<double> active;                ///< values; Known::id is the place of the first of a list
  bool replaceable = false;                  ///< see SystemText
  std::vector<Formula> definitions;          ///< by Known::id; without nodes: not parsed yet
  std::map<std::string, Known, std::less<>> table;
  std::vector<std::string> indices;  ///< known outside every sum: i in formulas of an array

  const Known* find(std::string_view name) const;
  /// The kind of a definition.
  Kind of_definitions() const { return kind == Kind::hamiltonian ? kind : Kind::lagrangian; }
  /// Throws FormulaError where the name is malformed, reserved or taken.
  void declare(const std::string& name, Known known, const std::string& where);
  void declare(const Coordinate& coordinate, const std::string& where);
  /// Declares p_x for each coordinate x.
  void declare_momenta();
  /// Declares definitions, not parsed.
  void declare(const std::map<std::string, std::string>& definitions);
  /// Declares parameters; those of `active` stay symbolic.
  void declare(const std::map<std::string, ParameterText>& texts, std::span<const std::string> active,
               bool replaceable = false);
};

/// Coordinates, parameters and parsed definitions of a system. Throws FormulaError.
Names names_of(const SystemText& text);

Names names_of(Kind kind, const Vocabulary& vocabulary);

/// Gives every name in the formula its meaning, and likewise in all definitions that it needs, which are
/// parsed for that.
void resolve(Formula& formula, Names& names);

/// Parses all definitions. Throws FormulaError, also for a cycle among them.
void parse_definitions(Names& names);

/// Makes i = `index` known to a formula, unless it is 0, and resolves that. Returns the values of the
/// indices.
std::vector<double> resolve_at(Formula& formula, Names& names, int index);

}  // namespace extremal::formula
