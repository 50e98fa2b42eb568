#pragma once

#include <memory>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/adapt/options.hpp"

/// \file The front door: a problem in, an extremal out.

namespace extremal {

/// Keeps memory between solves, nothing else. Not for two threads at once.
class Solver {
 public:
  Solver();
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  Solution solve(const Problem& problem, const SolveOptions& options = {});

  /// Up to `most` distinct extremals of one problem, sorted by action. Of a continuum, as of the time shifts
  /// of a periodic orbit, one. Each one's iterations and seconds count from the beginning; if fewer are found
  /// than asked for, the message of the first says so. Where none is found, one solution that has not
  /// converged. From initial data there is one motion.
  std::vector<Solution> solve_all(const Problem& problem, const SolveOptions& options, int most);

 private:
  std::vector<Solution> combined_from_legs(const Problem& problem, const SolveOptions& options, int most);

  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace extremal
