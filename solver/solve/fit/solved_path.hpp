#pragma once

#include <memory>
#include <vector>

#include "solve/fit/fitted_extremal.hpp"

/// \file Extremals with constraints, integrals or waypoints, for changing values of the unknowns of a fit.

namespace extremal {

/// Each is solved for by itself, from the one before. Derivatives are differences of extremals.
class SolvedPath final : public FittedExtremal {
 public:
  /// `task` must outlive it.
  SolvedPath(const FitTask& task, const SolveOptions& options);

  void take(const Solution& solution, std::span<const double> values) override;
  bool evaluate(std::span<const double> values, std::span<double> residuals,
                std::span<double> jacobian) override;
  bool evaluate_by_values(std::span<double> residuals, std::span<double> jacobian) override;
  bool converge_on_elements() override { return path_.elements() > 0; }
  std::vector<double> coordinates() const override { return values_; }
  std::vector<double> values() const override { return values_; }
  const Path& path() const override { return path_; }
  int iterations() const override { return iterations_; }

 private:
  bool solve(std::span<const double> values, Solution& solution);
  bool put(const Solution& solution, std::span<const double> values, std::span<double> residuals);
  bool differentiate(std::size_t unknown, std::size_t count, std::span<double> jacobian);

  const FitTask& task_;
  const SolveOptions& options_;
  Observer observer_;
  std::shared_ptr<const Lagrangian> lagrangian_;  ///< to which the tables are bound
  std::unique_ptr<SchemeTables> scheme_;
  ElementTables tables_;
  Path path_;
  Solution solution_;           ///< of `path_`
  std::vector<double> values_;  ///< likewise
  int iterations_ = 0;
};

}  // namespace extremal
