#pragma once

#include <memory>
#include <vector>

#include "solve/fit/fitted_extremal.hpp"
#include "solve/newton/iteration.hpp"

/// \file Extremals on given elements, for changing values of the unknowns of a fit.

namespace extremal {

/// Follows an extremal from values to values. Newton's method begins where derivatives at the last values
/// lead.
///
/// Beyond a conjugate time the end q(T) is a bad unknown: where T is conjugate to 0, for some values of the
/// others, paths between given ends have no bound. In its place stands q at a node before, to which the
/// Jacobi fields that vanish at 0 are far from vanishing again. Paths are then solved for with that value
/// given, by the same factors: what is left free is a combination of the fields that q(T) moves. Values in
/// this form are called coordinates of a path.
///
/// Closed orbits are members of families: nothing but data tells where on an orbit time begins, how it is
/// turned where L can be turned, and which of a continuum of orbits it is. Steps along the family have
/// coordinates as well; Newton's method keeps them to first order.
class FittedPath final : public FittedExtremal {
 public:
  /// From an extremal of task.at(values), on elements of its own. `task` must outlive it.
  FittedPath(const FitTask& task, const SolveOptions& options);

  void take(const Solution& solution, std::span<const double> values) override;
  bool evaluate(std::span<const double> coordinates, std::span<double> residuals,
                std::span<double> jacobian) override;
  bool evaluate_by_values(std::span<double> residuals, std::span<double> jacobian) override;
  bool converge_on_elements() override;
  std::vector<double> coordinates() const override;
  std::vector<double> values() const override;
  const std::vector<Step>& members() const override { return members_; }
  const Path& path() const override { return path_; }
  int iterations() const override { return iterations_; }

 private:
  bool bind(std::span<const double> values);
  bool move_to(std::span<const double> coordinates);
  bool converge_here(std::span<const double> coordinates);
  std::vector<double> values_at(std::span<const double> coordinates) const;
  bool correct_end(std::span<const double> coordinates);
  bool correct(std::span<const double> coordinates);
  bool hold_node(std::span<const double> coordinates, std::span<const ProblemChange> changes, Step& step);
  bool differentiate(bool by_values, std::span<double> jacobian);
  bool find_members(std::size_t at_least);
  bool close(Step& member);
  bool within_family();
  void choose_node();
  Eigen::MatrixXd fields_at(int node) const;
  void combine_fields();

  const FitTask& task_;
  const SolveOptions& options_;
  Observer observer_;
  std::optional<FittedProblem> at_;
  std::unique_ptr<SchemeTables> scheme_;
  ElementTables tables_;
  NewtonIteration newton_;
  ExtremalResponse response_;
  Path path_, base_;                 ///< at the last values; where derivatives are known
  std::vector<double> asked_;        ///< coordinates that led to `path_`
  std::vector<double> values_;       ///< of `path_`, but for those of ends_, then of members
  std::vector<double> base_values_;  ///< coordinates of `base_`
  std::vector<Step> steps_;          ///< derivatives of `base_` by the unknowns, then members; or none
  std::vector<Step> members_;        ///< at `path_`, or where it came from
  PhaseConditions held_;             ///< those that Newton's method does not know
  std::vector<std::size_t> ends_;    ///< unknowns that are q(T)
  std::vector<Step> fields_;         ///< what each of them moves
  int node_ = 0;                     ///< at which q stands for them; N: at T itself
  bool converged_ = false;           ///< `path_` is an extremal at `values_`
  int iterations_ = 0;
};

}  // namespace extremal
