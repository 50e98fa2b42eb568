#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scene/source.hpp"

/// \file A scene as data: what is written, with its places, and nothing computed from it.

namespace extremal {

struct Number {
  double value = 0;
  Location at;
};

/// A number, or a formula for one.
struct Quantity {
  std::variant<double, std::string> value;
  Location at;
  bool formula() const { return std::holds_alternative<std::string>(value); }
};

/// name = value, or name = [values].
struct Assignment {
  std::string name;
  Location name_at;
  std::vector<Quantity> values;
  bool list = false;
  Location at;  ///< of the value
};

struct Definition {
  std::string name;
  Location name_at;
  Text formula;
};

/// [system], merged with the system file that it uses.
struct SystemTable {
  Location at;
  std::optional<Text> use;
  std::vector<Text> coordinates;
  std::vector<Assignment> parameters;
  std::vector<Definition> definitions;
  std::optional<Text> lagrangian, hamiltonian;  ///< one of them
  std::vector<Assignment> force;
  std::vector<Text> constraints;
  std::optional<Number> curvature;
  std::vector<Text> axes, centres;  ///< of [about], as written

  /// The Lagrangian or the Hamiltonian.
  const Text& law() const { return hamiltonian ? *hamiltonian : *lagrangian; }
};

struct BoundaryTable {
  Location at;
  std::vector<Assignment> start, end, map;
  bool periodic = false;
  std::vector<Text> conditions;
  Quantity duration;
  bool free = false;      ///< duration = "free"
  bool infinite = false;  ///< duration = "infinite"
  std::optional<Quantity> energy;
  std::optional<Text> where;     ///< where it is one, and there are no unknowns
  std::vector<Text> where_list;  ///< else
  std::vector<Text> integrals;
  std::vector<Assignment> unknowns;  ///< parameters to be found, with guesses
};

/// Of [[waypoints]]: coordinates that are fixed at a time.
struct WaypointTable {
  Location at;
  Quantity time;
  bool free = false;  ///< at = "free"
  std::vector<Assignment> values;
};

/// [path]: inequalities along the whole path.
struct PathTable {
  Location at;
  std::vector<Text> constraints;
};

/// [guess]: formulas, a file or a state; empty for the default guess.
struct GuessTable {
  Location at;
  std::vector<Assignment> formulas;
  std::optional<Text> file;
  std::optional<Number> orbit;  ///< of a file with several
  std::optional<std::vector<Assignment>> state;
  std::optional<Quantity> duration;
};

struct SolveTable {
  std::optional<Number> tolerance;
  std::optional<Text> scheme;
  std::optional<Number> elements;
  std::optional<Text> steps;     ///< "free"
  std::optional<Number> budget;  ///< s
  std::optional<Text> method;    ///< one of method_records()
};

struct SearchTable {
  Number solutions;  ///< how many are wanted
};

/// The lines of each coordinate.
struct SpectrumTable {
  std::optional<Number> lines;
  std::optional<Text> against;  ///< a result that has a spectrum
};

/// What lengths and times are in space.
struct UnitsTable {
  Location at;
  std::optional<Number> length, time;  ///< km, s
  std::optional<Text> frame, centre, epoch;
};

/// A family of problems: "duration", "energy" or a parameter of the system varies.
struct ContinuationTable {
  Location at;
  Text parameter;
  Number to;
  std::optional<Number> points;  ///< at most, of each branch
  bool switching = false;        ///< also follow the branches that bifurcate
};

/// What observations are to determine.
struct FitTable {
  Location at;
  Text data;
  std::vector<Definition> observe;
  std::vector<Text> parameters;
  std::optional<Text> loss;  ///< "squared", "huber", "cauchy"
};

struct Scene {
  std::string path;
  std::vector<std::string> files;  ///< that were read: the scene, and the system file that it uses
  std::string title;
  SystemTable system;
  BoundaryTable boundary;
  std::vector<WaypointTable> waypoints;
  std::optional<PathTable> inequalities;  ///< of [path]
  GuessTable guess;
  SolveTable solve;
  std::optional<SearchTable> search;
  std::optional<ContinuationTable> continuation;
  std::optional<SpectrumTable> spectrum;
  std::optional<UnitsTable> units;
  std::optional<FitTable> fit;
};

/// The text of a scene file. Throws as read_source() does; where the file is missing, a scene of that name in
/// the library is named.
std::shared_ptr<const Source> scene_source(const std::string& path);

/// Reads a scene with the changes "key=value" to it. Throws SceneError (UnknownName for a misspelt name).
Scene read_scene(const std::string& path, const std::vector<std::string>& sets = {});

/// The same of a text. Files that it names are looked up beside its name, as if that were its path.
Scene read_scene(const std::shared_ptr<const Source>& text, const std::vector<std::string>& sets = {});

}  // namespace extremal
