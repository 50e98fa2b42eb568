#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"
#include "solve/external/curve_fit.hpp"
#include "solve/fit/observations.hpp"

/// \file Extremals that fit observations.

namespace extremal {

/// A number that observations are to determine.
struct FitUnknown {
  std::string name;
  double start = 0;
  double size = 1;  ///< its order of magnitude
  int last = -1;    ///< of an end at t = T its coordinate
};

/// What values of the unknowns make of the problem.
struct FittedProblem {
  /// All ends are determined; with forces, that of both copies.
  Problem problem;
  std::vector<ProblemChange> changes;  ///< of it with each unknown
  bool curved = false;                 ///< ends are no linear functions of those that are unknowns
  ObservedFormulas formulas;           ///< with the same active parameters
};

/// Σ ρ((observed − computed)²/σ²) is to be least.
struct FitTask {
  std::vector<FitUnknown> unknowns;
  /// Nothing where there is no such problem.
  std::function<std::optional<FittedProblem>(std::span<const double> values)> at;
  /// The same problem as Solver takes it, with a guess; nothing likewise.
  std::function<std::optional<Problem>(std::span<const double> values, const Guess& guess, double duration)>
      problem;
  /// Where `at` is empty, as with constraints, integrals and waypoints: formulas of observations for these
  /// values. Derivatives are then differences.
  std::function<ObservedFormulas(std::span<const double> values)> formulas = {};
  /// An extremal of it.
  std::function<Solution(const Problem&, const SolveOptions&)> solve;
  Guess guess;
  double duration = 0;  ///< or its guess, where it is free
  int coordinates = 0;  ///< of one copy
  bool closed = false;  ///< orbits of a period that is given
  Observations data;
  Loss loss = Loss::squared;
};

/// A stage of the fit.
struct FitStep {
  int iteration = 0, elements = 0, degree = 0;
  double chi_squared = 0;
};

struct FitResult {
  Solution solution;           ///< that fits; else says why there is none
  std::vector<double> values;  ///< of the unknowns
  /// Of the unknowns: (JᵀWJ)⁻¹ with J the derivatives of (observed − computed)/σ and W = ρ'. Where no σ is
  /// given, times Σ ρ/(values − unknowns): the scatter of the residuals then tells their σ. Which member of a
  /// family an extremal is, as where on a closed orbit time begins, is unknown as well, but no result.
  Eigen::MatrixXd covariance;
  bool scaled = false;                         ///< by that
  int freedom = 0;                             ///< values less unknowns
  double chi_squared = 0;                      ///< Σ ρ
  std::vector<std::vector<double>> residuals;  ///< observed − computed, of each column
};

/// A trajectory at the nodes of its elements.
Guess guess_of_elements(const Trajectory& trajectory);

/// Fits by Ceres around extremals on elements that are kept while it iterates. They are then chosen anew for
/// the extremal that was found, until they meet the tolerance along it. Where observations do not determine
/// an unknown the solution has not converged, and its message names it.
FitResult fit(const FitTask& task, const SolveOptions& options,
              const std::function<void(const FitStep&)>& progress = {});

}  // namespace extremal
