#include "solve/contact/contact_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "machine/clock.hpp"
#include "problem/inequalities.hpp"
#include "solve/contact/contact_search.hpp"
#include "solve/contact/first_paths.hpp"
#include "solve/contact/limits.hpp"
#include "solve/search/distinct.hpp"

namespace extremal {

using namespace limits::contact;

Solution solve_with_inequalities(const Problem& problem, const SolveOptions& options, const ArcSolve& solve) {
  const auto start = Clock::now();
  const CoarseAction action(problem, CoarseElements{coarse_elements[0]});
  ContactSearch search(problem, options, solve, false);
  Solution solution = search.run(first_path(problem, action));
  // From a path that is symmetric, the method may come to a saddle: beside it there are minima. The steps of
  // a coarse path may also lead through what is forbidden.
  const bool bounded = search.saddle() || search.no_duration() || solution.status == Status::not_converged;
  int attempts = search.attempts();
  for (int number = 0; !solution.converged() && bounded && number < most_bends && attempts < most_attempts &&
                       !options.deadline.passed();
       ++number)
    if (const std::optional<std::vector<double>> z = bent_path(problem, action, number)) {
      ContactSearch beside(problem, options, solve, false);
      Solution other = beside.run(*z);
      attempts += beside.attempts();
      if (!other.converged()) continue;
      solution = std::move(other);
    }
  solution.seconds_solve = seconds_since(start) - solution.seconds_analyse;
  return solution;
}

std::vector<Solution> minimisers(const Problem& problem, const SolveOptions& options, int most,
                                 const ArcSolve& solve) {
  const auto start = Clock::now();
  const CoarseAction action(problem, CoarseElements{coarse_elements[0]});
  std::vector<Solution> found;
  std::vector<char> singular;
  Solution failure;
  int vain = 0, tried = 0;
  const bool shifts = problem.shifts_in_time() && problem.inequalities->all->autonomous();
  const auto same = [&](const Solution& a, const Solution& b, bool continua) {
    return shifts || continua ? same_orbit(a, b, options.tolerance) : same_path(a, b, options.tolerance, 0);
  };
  // As many as wanted of less action than what a path leads to at the least.
  const auto enough_below = [&](double action) {
    const auto below = [&](const Solution& solution) { return solution.action <= action; };
    return std::ranges::count_if(found, below) >= most || options.deadline.passed();
  };
  const auto pursue = [&](const std::vector<double>& z) {
    ++tried;
    ++vain;
    ContactSearch search(problem, options, solve, true);
    Solution solution = search.run(z);
    if (!solution.converged()) {
      if (tried == 1) failure = std::move(solution);
      return;
    }
    for (std::size_t i = 0; i < found.size(); ++i)
      if (same(found[i], solution, singular[i] != 0 && search.singular())) return;
    vain = 0;
    solution.seconds_solve = seconds_since(start);
    found.push_back(std::move(solution));
    singular.push_back(search.singular());
  };
  pursue(first_path(problem, action));
  for (const FirstPath& path : paths_by_sides(problem, action)) {
    const double least = path.action ? *path.action - tight_action * std::abs(*path.action) : INFINITY;
    if (!enough_below(least)) pursue(path.nodes);
  }
  vain = 0;
  for (int number = 0; number < bent_paths(problem) && vain < most_in_vain && !enough_below(INFINITY);
       ++number)
    if (const std::optional<std::vector<double>> z = bent_path(problem, action, number)) pursue(*z);
  if (found.empty()) return {std::move(failure)};
  sort_by_action(found);
  if (static_cast<int>(found.size()) > most) found.resize(most);
  if (static_cast<int>(found.size()) < most)
    found.front().message += fmt::format(
        "; {} of {} local minimisers wanted were found from {} first paths; "
        "more may exist",
        found.size(), most, tried);
  else if (most > 1)
    found.front().message += fmt::format(
        "; these {} local minimisers were found from {} first paths; others may exist, of less action too",
        most, tried);
  return found;
}

}  // namespace extremal
