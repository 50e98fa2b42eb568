#include "solve/minimal_solve.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "solution/from_minimal.hpp"
#include "solve/limits.hpp"

namespace extremal {

std::optional<Solution> solve_minimal(
    const Problem& problem, const SolveOptions& options,
    const std::function<Solution(const Problem&, const SolveOptions&)>& solve) {
  const std::shared_ptr<const MinimalProblem> minimal = problem.manifold->parts().minimal;
  const bool only = problem.manifold->parts().only_minimal;
  if (only &&
      (!minimal || options.scheme || options.method != Method::newton || !describes(*minimal, problem)))
    throw std::invalid_argument("the ends of the problem are available in minimal coordinates alone");
  if (!minimal || options.scheme || options.method != Method::newton || !describes(*minimal, problem))
    return std::nullopt;
  SolveOptions own = options;
  if (!only) own.deadline = options.deadline.share(limits::minimal_solve::share);
  own.tolerance /= minimal->stretch;
  if (problem.initial) {
    // Whether the motion stays in the chart is told more cheaply by a coarse march.
    SolveOptions coarse = own;
    coarse.tolerance = std::max(own.tolerance, limits::minimal_solve::coarse);
    coarse.progress = nullptr;
    if (!solve(minimal->problem, coarse).converged()) return std::nullopt;
  }
  Solution solution = solve(minimal->problem, own);
  Solution failed;
  failed.status = solution.status;
  failed.message = solution.message;
  std::optional<Solution> found;
  if (solution.converged()) {
    found = from_minimal(problem, *minimal, std::move(solution), options.tolerance);
    failed.status = Status::not_converged;
    failed.message =
        "the path leaves the coordinates that were chosen near the guess; give a guess nearer to it";
  }
  if (!found && only) return failed;
  return found;
}

}  // namespace extremal
