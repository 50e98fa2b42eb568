#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "solve/fit/fitted_extremal.hpp"

/// \file Extremals with constraints, integrals or waypoints, for changing values of the unknowns of a fit.

namespace extremal {

/// Each is solved for by itself, from the one before or beside it along its family. Derivatives by values are
/// differences of extremals.
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
  std::vector<double> values() const override {
    return {values_.begin(), values_.begin() + std::ssize(task_.unknowns)};
  }
  const std::vector<Step>& members() const override { return members_; }
  const Path& path() const override { return path_; }
  int iterations() const override { return iterations_; }

 private:
  bool solve(std::span<const double> values, Solution& solution);
  bool put(const Solution& solution, std::span<const double> values, std::span<double> residuals);
  bool differentiate(std::size_t unknown, std::size_t count, std::span<double> jacobian);

  const FitTask& task_;
  const SolveOptions& options_;
  Observer observer_;
  std::optional<Problem> problem_;  ///< to which the tables are bound
  std::unique_ptr<SchemeTables> scheme_;
  ElementTables tables_;
  Path path_;
  Solution solution_;           ///< of `path_`
  std::vector<Step> members_;   ///< likewise
  std::vector<double> values_;  ///< likewise, then coordinates along members
  int iterations_ = 0;
};

}  // namespace extremal
