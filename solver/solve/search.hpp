#pragma once

#include <vector>

#include "solve/refinement.hpp"
#include "solve/start.hpp"

/// \file Where Newton's method starts from: the guess, and what else where that fails.

namespace extremal {

/// Starting paths in turn, cheapest first, each pursued to the tolerance, within a bounded number of steps.
class Search {
 public:
  Search(const Problem& problem, const SolveOptions& options, Workspace& workspace);
  Outcome run();

 private:
  void start(const std::vector<double>& mesh, const Bend& bend);
  bool begin(std::vector<double>& mesh, Bend& bend);
  Refinement::Result from_other_guesses(const std::vector<double>& mesh, const Bend& bend);

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Outcome outcome_;
  Refinement refinement_;
  std::vector<double> ends_;
};

}  // namespace extremal
