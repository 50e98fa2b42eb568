#pragma once

#include <algorithm>

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/residual_test.hpp"

/// \file A scheme that the user names: exactly so many equal elements, or as many as the tolerance needs.

namespace extremal {

/// Solves the discrete equations of `options.scheme` to roundoff and estimates the error against elements
/// of higher degree on the same mesh. With options.elements = 0 the number of elements grows until
/// the estimate meets the tolerance.
class PinnedSolve {
 public:
  PinnedSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace);
  Outcome run();

 private:
  NewtonReport run_newton(const ElementTables& tables, Path& path, double goal, int most_steps);
  NewtonReport converge_to_roundoff();
  bool solve_discrete(int elements);
  bool quadrature_is_exact();
  bool free_times();
  bool holds_energy(const Resolution::Error& left_out);
  NewtonReport converge_with_kinks(const ElementTables& tables, NewtonReport report);
  int kinked_elements() const;
  double distance_to_companion();
  double velocity_excess();
  double wanted_growth(double excess) const;
  int most_affordable();
  void spend_budget(int elements);
  void accept(const Scales& size);
  /// Of the error of q throughout, not of the nodes alone.
  int order() const { return std::min(scheme_.order, scheme_.degree + 1); }
  void bind(int points);

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Scheme scheme_;
  Outcome outcome_;
  Path& path_ = outcome_.path;
  Path saved_;
  double magnitude_ = 0;  ///< of the guess
  double cost_ = 0;       ///< nanoseconds so far, by batch_cost()
};

}  // namespace extremal
