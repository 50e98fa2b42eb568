#pragma once

#include "rivals/verify.hpp"
#include "solve/laws.hpp"
#include "solve/search/search.hpp"

/// \file Paths that are refused, and the solutions that a solve goes on to.

namespace extremal::laws {

/// Acceptance of the first path that meets the tolerance, where a solve would go on after a refusal. With a
/// scheme that is given a solve has no other.
inline Solution first_judged(const Problem& problem, const SolveOptions& options) {
  if (options.scheme) return Solver().solve(problem, options);
  Workspace w;
  w.levels.bind(problem.lagrangian);
  Search search(problem, options, w);
  const Outcome& found = search.run();
  return found.status == Status::converged ? accept(problem, options, found, w)
                                           : explain_failure(problem, options, found, w);
}

/// Expects of a solution after a refusal that integration, piece by piece, confirms it.
inline void expect_verified(const Problem& problem, const Solution& s, double tolerance) {
  const Verification found = verify(problem, s.trajectory, {.tolerance = tolerance});
  EXPECT_TRUE(found.verified) << s.strategy << ", " << s.error_estimate << ": " << found.message;
}

}  // namespace extremal::laws
