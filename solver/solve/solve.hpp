#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "action/scheme.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file The front door: a problem in, an extremal out.

namespace extremal {

struct SolveOptions {
  double tolerance = 1e-9;       ///< of q(t), relative to the largest range of a coordinate
  std::optional<Scheme> scheme;  ///< this scheme, N adapted; absent: chosen
  int elements = 0;              ///< with scheme: exactly so many equal elements; excludes tolerance
  int max_iterations = 4000;     ///< Newton steps in all, restarts from other guesses included
  std::function<void(const Iteration&)> progress;
};

/// Keeps memory between solves, nothing else. Not for two threads at once.
class Solver {
 public:
  Solver();
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  Solution solve(const Problem& problem, const SolveOptions& options = {});

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace extremal
