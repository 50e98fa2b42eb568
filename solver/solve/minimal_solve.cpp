#include "solve/minimal_solve.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "problem/manifold.hpp"
#include "solution/from_minimal.hpp"
#include "solve/limits.hpp"

namespace extremal {

namespace {

using Solve = std::function<Solution(const MinimalProblem&, const SolveOptions&)>;

/// In one chart. Nothing where the path leaves it; `failed` is then what to say.
std::optional<Solution> solve_in(const MinimalProblem& minimal, const Problem& problem,
                                 const SolveOptions& options, const Solve& solve, Solution& failed) {
  SolveOptions own = options;
  if (!problem.manifold->parts().only_minimal)
    own.deadline = options.deadline.share(limits::minimal_solve::share);
  own.tolerance /= minimal.stretch;
  if (problem.initial) {
    // Whether the motion stays in the chart is told more cheaply by a coarse march.
    SolveOptions coarse = own;
    coarse.tolerance = std::max(own.tolerance, limits::minimal_solve::coarse);
    coarse.progress = nullptr;
    if (!solve(minimal, coarse).converged()) return std::nullopt;
  }
  Solution solution = solve(minimal, own);
  failed.status = solution.status;
  failed.message = solution.message;
  if (!solution.converged()) return std::nullopt;
  failed.status = Status::not_converged;
  failed.message =
      "the path leaves the coordinates that were chosen near the guess; give a guess nearer to it";
  return from_minimal(problem, minimal, std::move(solution), options.tolerance);
}

}  // namespace

std::optional<Solution> solve_minimal(const Problem& problem, const SolveOptions& options,
                                      const Solve& solve) {
  const Manifold::Parts& parts = problem.manifold->parts();
  const bool suits = !options.scheme && options.method == Method::newton;
  std::optional<Solution> failed;
  for (const MinimalProblem* in = parts.minimal.get(); suits && in; in = in->next.get()) {
    if (!describes(*in, problem)) continue;
    Solution why;
    if (std::optional<Solution> found = solve_in(*in, problem, options, solve, why)) return found;
    if (!failed) failed = std::move(why);
  }
  if (!parts.only_minimal) return std::nullopt;
  if (!failed)
    throw std::invalid_argument("the ends of the problem are available in minimal coordinates alone");
  return failed;
}

}  // namespace extremal
