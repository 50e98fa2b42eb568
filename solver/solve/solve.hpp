#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "action/scheme.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file The front door: a problem in, an extremal out.

namespace extremal {

/// What leads from a guess to where Newton's method ends it.
enum class Method {
  newton,  ///< itself
  ceres,   ///< least squares of δS_h by Levenberg and Marquardt's method (Ceres Solver)
  ipopt,   ///< δS_h = 0 as constraints of an interior point method with a filter line search (Ipopt)
};

/// Its name, "newton", "ceres" or "ipopt".
const char* name(Method method);
/// Whether this build has it.
bool available(Method method);

struct SolveOptions {
  double tolerance = 1e-9;       ///< of q(t), relative to the largest range of a coordinate
  std::optional<Scheme> scheme;  ///< this scheme, N adapted; absent: chosen
  int elements = 0;              ///< with scheme: exactly so many equal elements; excludes tolerance
  Method method = Method::newton;
  int max_iterations = 8000;  ///< Newton steps in all, restarts from other guesses included
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

  /// Up to `most` distinct extremals of one problem, sorted by action. Of a continuum, as of the time shifts
  /// of a periodic orbit, one. Each one's iterations and seconds count from the beginning; if fewer are found
  /// than asked for, the message of the first says so. Where none is found, one solution that has not
  /// converged.
  std::vector<Solution> solve_all(const Problem& problem, const SolveOptions& options, int most);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace extremal
