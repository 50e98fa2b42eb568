#pragma once

#include "solve/converge.hpp"
#include "solve/residual_test.hpp"
#include "solve/workspace.hpp"

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
  bool solve_discrete(int elements);
  bool exact_quadrature_settled();
  double distance_to_companion();
  void bind(int points);

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Scheme scheme_;
  Outcome outcome_;
};

}  // namespace extremal
