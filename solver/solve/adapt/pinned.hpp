#pragma once

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/residual_test.hpp"

/// \file A scheme that the user names: exactly so many equal elements, or as many as the tolerance needs.

namespace extremal {

/// Where the equations are solved from. With `homotopy` a path near which Newton's method finds no solution
/// is taken to one by ResidualHomotopy; seeds other than 0 bend it first, or move the times of its nodes
/// where these are free.
struct SchemeStart {
  bool homotopy = false;
  unsigned seed = 0;
};

/// Solves the discrete equations of `options.scheme` to roundoff and estimates the error against elements
/// of higher degree on the same mesh. With options.elements = 0 the number of elements grows until
/// the estimate meets the tolerance.
class PinnedSolve {
 public:
  PinnedSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace,
              const SchemeStart& start);
  /// Whether there is a homotopy to its equations.
  static bool has_homotopy(const Problem& problem, const SolveOptions& options);
  Outcome run();

 private:
  NewtonReport run_newton(const ElementTables& tables, Path& path, double goal, int most_steps);
  NewtonReport converge_to_roundoff();
  void start_path_on(const std::vector<double>& mesh);
  bool solve_equations();
  bool solve_discrete(int elements);
  bool quadrature_is_exact();
  bool trace_residual(bool free_times);
  bool holds_energy(const Resolution::Error& left_out);
  NewtonReport converge_with_kinks(const ElementTables& tables, NewtonReport report);
  int kinked_elements() const;
  double distance_to_companion();
  double velocity_excess();
  int most_affordable();
  void spend_budget(int elements);
  void accept(const Scales& size);
  void bind(int points);

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Scheme scheme_;
  const SchemeStart start_;
  Outcome outcome_;
  Path& path_ = outcome_.path;
  Path saved_;
  double magnitude_ = 0;  ///< of the guess
  double cost_ = 0;       ///< nanoseconds so far, by batch_cost()
};

}  // namespace extremal
