#pragma once

#include <memory>
#include <vector>

#include "solve/fit/fit.hpp"
#include "solve/newton/iteration.hpp"

/// \file Extremals on given elements, for changing values of the unknowns of a fit.

namespace extremal {

/// Follows an extremal from values to values. Newton's method begins where derivatives at the last values lead.
class FittedPath {
 public:
  /// From an extremal of task.at(values), on elements of its own. `task` must outlive it.
  FittedPath(const FitTask& task, const SolveOptions& options);

  /// Takes an extremal that was found for these values, on its mesh.
  void take(const Solution& solution, std::span<const double> values);

  /// (observed − computed)/σ at the values and, unless `jacobian` is empty, the derivatives by rows. False where
  /// there is no extremal near, or one is not finite.
  bool evaluate(std::span<const double> values, std::span<double> residuals, std::span<double> jacobian);

  const Path& path() const { return path_; }
  int iterations() const { return iterations_; }

 private:
  bool bind(std::span<const double> values);
  bool move_to(std::span<const double> values);
  bool converge_here();
  bool differentiate(std::span<double> jacobian);

  const FitTask& task_;
  const SolveOptions& options_;
  Observer observer_;
  std::optional<FittedProblem> at_;
  std::unique_ptr<SchemeTables> scheme_;
  ElementTables tables_;
  NewtonIteration newton_;
  ExtremalResponse response_;
  Path path_, base_;              ///< at the last values; where derivatives are known
  std::vector<double> values_, base_values_;
  std::vector<Step> steps_;       ///< derivatives of `base_` by the unknowns; or none
  bool converged_ = false;        ///< `path_` is an extremal at `values_`
  int iterations_ = 0;
};

}  // namespace extremal
