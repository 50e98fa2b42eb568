#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "solve/fit/fit.hpp"
#include "study/constraints/constraints.hpp"
#include "system/formula.hpp"

/// \file A scene for any values of the parameters and end coordinates that a fit looks for.

namespace extremal {

/// The problem of a scene, with this guess in place of its own.
using ProblemOf = std::function<Problem(const Scene& scene, const Guess& guess, double duration)>;

/// An end coordinate that a fit looks for.
struct OpenEnd {
  int e = 0;  ///< as EndMap numbers it
  std::string name;
};

class FittedScene {
 public:
  /// `problem` is that of the scene, and `load` makes those of scenes like it. Throws SceneError for what
  /// cannot be fitted.
  FittedScene(const Scene& scene, const System& system, const Problem& problem, ProblemOf load);

  const std::vector<OpenEnd>& open() const { return open_; }
  const std::vector<std::string>& parameters() const { return parameters_; }
  /// Of the parameters in the scene.
  std::vector<double> start() const;

  /// Whether integrals, waypoints, ends in minimal coordinates alone, or kinks of forces, at times where
  /// elements end, ask for a problem that is made anew for all values.
  bool made_anew() const { return made_anew_; }

  /// Values: those of the parameters, then of the ends. Throw SceneError, or FormulaError of a definition.
  FittedProblem at(std::span<const double> values) const;
  Problem problem(std::span<const double> values, const Guess& guess, double duration) const;
  ObservedFormulas formulas(std::span<const double> values) const { return formulas(table_at(values)); }

 private:
  /// What formulas of the scene make of the parameters.
  struct Numbers {
    BoundaryRelation relation;  ///< with a row for each open end
    Duration duration;
    std::vector<double> active;  ///< values of the active parameters
    std::vector<double> list() const;
  };
  void read_parameters(const Scene& scene, const System& system);
  void find_dependent(const Scene& scene);
  void find_open(const System& system);
  bool is_open(int e) const;
  bool determined_by_constraints(int e, const Guess& guess) const;
  Scene scene_at(std::span<const double> values) const;
  void check_dependence() const;
  SystemTable table_at(std::span<const double> values) const;
  Numbers numbers(std::span<const double> values) const;
  void complete_by_constraints(const SystemTable& table, Numbers& numbers) const;
  ObservedFormulas formulas(const SystemTable& table) const;
  std::vector<Numbers> around(std::span<const double> values, std::size_t unknown, double& step) const;
  ProblemChange change(std::span<const double> values, const Problem& inner, std::size_t unknown) const;
  void put_relation_change(const Problem& inner, BoundaryRelation by, ProblemChange& change) const;
  Problem inner_problem(const Numbers& numbers, const SystemTable& table,
                        const std::vector<std::string>& active) const;

  Scene scene_;
  ProblemOf load_;
  bool made_anew_;
  FitTable fit_;
  SystemTable table_;
  BoundaryTable boundary_;
  System system_;
  Problem problem_;
  EndPoints near_;  ///< with constraints: the ends of the first path
  std::vector<std::string> parameters_, active_;
  std::vector<OpenEnd> open_;
  std::vector<int> ends_left_;       ///< end coordinates that the relation leaves open
  std::vector<int> determined_;      ///< of these, what constraints determine by the others
  std::set<std::string> dependent_;  ///< names whose values depend on those of the parameters
  bool boundary_depends_ = false;
};

}  // namespace extremal
