#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "system/lagrangian.hpp"

/// \file Systems and conditions written as formulas.

namespace extremal {

struct ConstrainedGraph;
struct LagrangianGraph;

/// A formula that does not parse or names what does not exist. `where` says which text (see
/// SystemText), `offset` is the position in it, in bytes.
struct FormulaError : std::runtime_error {
  std::string where;
  std::size_t offset;
  FormulaError(std::string message, std::string where, std::size_t offset)
      : std::runtime_error(std::move(message)), where(std::move(where)), offset(offset) {}
};

/// A parameter: a number, or a list of them read as m[1], m[2], …
using Parameter = std::vector<double>;
struct ParameterText {
  Parameter value;
  bool list = false;
};

/// A declared coordinate and where its elements stand in q.
struct Coordinate {
  std::string name;
  int first = 0;
  int count = 1;
  bool array = false;
};

/// What formulas may name: parameters, definitions, coordinates.
struct Vocabulary {
  Vocabulary(std::map<std::string, ParameterText> parameters = {},
             std::map<std::string, std::string> definitions = {})
      : parameters(std::move(parameters)), definitions(std::move(definitions)) {}

  std::map<std::string, ParameterText> parameters;
  std::map<std::string, std::string> definitions;  ///< parsed where a formula needs them
  std::vector<Coordinate> coordinates;
};

/// A parameter as it is written: numbers, and formulas of other parameters and of definitions.
struct ParameterEntry {
  std::vector<std::variant<double, std::string>> values;
  bool list = false;
};

/// The values of parameters, each after those that its formulas need. Where a FormulaError comes from is
/// named "parameters.m[2]" for the second value of m, or "definitions.r". Throws FormulaError, also for a
/// cycle.
std::map<std::string, ParameterText> evaluate_parameters(
    const std::map<std::string, ParameterEntry>& entries,
    const std::map<std::string, std::string>& definitions);

/// A system as text: a Lagrangian, or a Hamiltonian of coordinates and momenta p_x, p_x[i]. Where a
/// FormulaError comes from is named "coordinates[0]", "definitions.r", "lagrangian", "hamiltonian".
struct SystemText {
  std::vector<std::string> coordinates{};  ///< "x", "x[32]", "x[n]"
  std::map<std::string, ParameterText> parameters{};
  std::map<std::string, std::string> definitions{};
  std::string lagrangian{};
  std::optional<std::string> hamiltonian{};  ///< instead of the Lagrangian
  std::vector<std::string> active{};         ///< parameters that stay symbolic
  /// Active ones are there for Lagrangian::with() and may be lists. Else they are there for derivatives, and
  /// are single numbers.
  bool replaceable = false;
};

/// Of a Hamiltonian: by its Legendre transform, or in phase space, where momenta are coordinates.
enum class Formulation { legendre, phase_space };

struct System : Vocabulary {
  std::vector<std::string> names;  ///< of the coordinates, one an element: "x", "q[1]"
  /// In phase space H, with momenta for velocities: coordinates and names are then those of q and after them
  /// those of p ("p_x", "p_q[1]"), and the Lagrangian is that of phase_space.hpp in units of one. Else null.
  std::shared_ptr<const LagrangianGraph> hamiltonian;
  std::shared_ptr<const Lagrangian> lagrangian;
  std::shared_ptr<const Lagrangian> copies;  ///< with forces: see two_copies(). Null: there are none
};

/// The force on q[first] … q[first + count - 1]: one formula for all of them, in the index i.
struct ForceText {
  int first = 0, count = 1;
  int index = 0;  ///< i of the first in its array; 0 for a coordinate that is none: then there is no i
  std::string formula{};
  std::string where{};  ///< names the text in errors
};

/// The Lagrangian of two copies of a system with forces, of which the last `shared` coordinates are
/// constants, see two_copies(). Throws FormulaError.
std::shared_ptr<const Lagrangian> compile_forces(const SystemText& text, std::span<const ForceText> forces,
                                                 int shared = 0);

/// An equation "left = right" between coordinates; `where` names the text in errors.
struct ConstraintText {
  std::string formula{}, where{};
};

/// A system with the left sides (left − right) of its constraints and its forces. Throws FormulaError, also
/// for a constraint that is not smooth.
ConstrainedGraph constrained_graph(const SystemText& text, std::span<const ConstraintText> constraints,
                                   std::span<const ForceText> forces = {});

/// Parses, differentiates and compiles. Throws FormulaError, and SingularHamiltonian (hamiltonian.hpp) where
/// the Legendre transform is asked for and the second derivative by the momenta is singular.
System compile(const SystemText& text, Formulation formulation = Formulation::legendre);

/// A number written as a formula of parameters and of definitions that are numbers ("2*pi/omega") and, for an
/// element of an array, the index i = `index` >= 1 (0: there is none). `where` names the text in errors.
double number(const std::string& formula, const Vocabulary& vocabulary, const std::string& where,
              int index = 0);

/// Coordinates and velocities at both ends, n entries each.
struct EndValues {
  std::span<const double> q_start, v_start, q_end, v_end;
};

/// The value of a formula at the ends of a trajectory, perhaps not finite; `values` replaces numbers by name.
using EndQuantity = std::function<double(const EndValues& ends, const std::map<std::string, double>& values)>;

/// A formula of end values x(0), x[2]'(T), also of definitions, of parameters, and of `further` numbers where
/// the system has no parameter or definition of that name. `where` names the text in errors.
EndQuantity end_quantity(const std::string& formula, const System& system,
                         const std::map<std::string, double>& further, const std::string& where);

/// A guess x(t) as a formula of t, T, parameters, definitions of t alone and the index, as above. Returns the
/// values at each of `times`.
std::vector<double> tabulate(const std::string& formula, const Vocabulary& vocabulary, double duration,
                             std::span<const double> times, int index, const std::string& where);

/// An equation "left = right" between end values x(0), x[2](T) of coordinates and of definitions made of
/// them, and parameters, velocities excluded: g = left − right as a function of the 2n end coordinates
/// (start, then end).
struct EndEquation {
  bool affine = false;
  std::vector<Triplet> coefficients;  ///< (0, e, value), where affine
  double constant = 0;                ///< g = Σ coefficient·x_e + constant, where affine
  std::function<double(std::span<const double> start, std::span<const double> end,
                       std::span<double> gradient)>
      function;
};
EndEquation end_equation(const std::string& text, const Vocabulary& vocabulary, const std::string& where);

/// A `map` entry: the coordinate's value at T as an affine formula of the coordinates at 0 and the index, as
/// for number(). Coefficients over the n coordinates, and the constant.
struct AffineForm {
  std::vector<Triplet> coefficients;  ///< (0, a, value)
  double constant = 0;
};
AffineForm affine_form(const std::string& formula, const Vocabulary& vocabulary, const std::string& where,
                       int index = 0);

/// The names that a formula is written with, functions and indices included. What follows a character that no
/// formula has is left out.
std::set<std::string> names_in(const std::string& formula);

/// The coordinate whose velocity a name of another notation means ("x" for dx, x_dot, v_x), or empty.
std::string velocity_meant(const std::string& name, std::span<const Coordinate> coordinates);

/// The nearest of `known` to a misspelt name, or one that begins with it, or empty if none is near.
std::string nearest_name(const std::string& name, std::span<const std::string> known);

}  // namespace extremal
