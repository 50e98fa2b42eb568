#include "solve/scheme_solve.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solution/guessed_by.hpp"
#include "solve/adapt/limits.hpp"
#include "solve/adapt/pinned.hpp"

namespace extremal {

namespace {

/// Of the time there is; the rest is for the scheme.
constexpr double search_share = 0.7;

class SchemeSolve {
 public:
  SchemeSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace,
              const std::function<Solution(const Problem&, const Outcome&)>& judge)
      : problem_(problem), options_(options), w_(workspace), judge_(judge) {}

  /// The first attempt, that with the guess.
  Solution from_guess() { return attempt(problem_, {}); }
  bool astray() const { return astray_; }

  /// From the extremal that is found without the scheme; where the equations of the scheme have no solution
  /// near, by homotopy from it and from the guess.
  Solution from_others(Solution first, const Solution& guide) {
    std::optional<Problem> guided;
    w_.levels.bind(problem_.lagrangian);
    of_guide_ = guide.iterations;
    if (guide.converged()) {
      guided = guessed_by(problem_, guide);
      Solution found = attempt(*guided, {});
      if (found.converged()) return told(std::move(found), guide.strategy + ", then the scheme from there");
    }
    if (options_.elements == 0 || !PinnedSolve::has_homotopy(problem_, options_))
      return unsolved(std::move(first), guide);
    // Times that are free ask for a path whose residual is small.
    std::vector<const Problem*> bases;
    if (guided) bases.push_back(&*guided);
    if (!guided || !options_.free_steps) bases.push_back(&problem_);
    std::string failure;
    for (unsigned seed = 0; seed < limits::pinned::most_seeds; ++seed)
      for (const Problem* base : bases) {
        if (spent()) return refused(std::move(first), std::move(failure));
        Solution found = attempt(*base, {.homotopy = true, .seed = seed});
        if (found.converged())
          return told(std::move(found),
                      base == &problem_ ? "homotopy in the residual from the guess"
                                        : guide.strategy + ", then homotopy in the residual of the scheme");
        if (failure.empty()) failure = std::move(found.message);
      }
    return refused(std::move(first), std::move(failure));
  }

 private:
  Solution attempt(const Problem& problem, const SchemeStart& start) {
    SolveOptions options = options_;
    options.max_iterations -= iterations_;
    const Outcome outcome = PinnedSolve(problem, options, w_, start).run();
    iterations_ += outcome.iterations;
    astray_ = outcome.astray;
    return judge_(problem, outcome);
  }
  bool spent() const { return iterations_ >= options_.max_iterations || options_.deadline.passed(); }
  /// Of times that are free the homotopy tells the node at which they fail.
  Solution refused(Solution first, std::string failure) const {
    first.iterations = iterations_ + of_guide_;
    if (first.status != Status::not_converged || failure.empty() || options_.deadline.passed()) return first;
    first.message =
        options_.free_steps
            ? std::move(failure)
            : fmt::format(
                  "{} Newton steps, from the guess, from an extremal without the scheme and by homotopy in "
                  "the residual, lead to no path that solves the equations of {} on {} elements ({}): "
                  "they may have no solution; try more elements, another scheme or another guess",
                  first.iterations, options_.scheme->name, options_.elements, first.message);
    return first;
  }
  /// Where there is no homotopy.
  Solution unsolved(Solution first, const Solution& guide) const {
    first.iterations = iterations_ + of_guide_;
    if (first.status != Status::not_converged || options_.deadline.passed()) return first;
    if (first.message == guide.message) return first;
    first.message = fmt::format(
        "{} Newton steps from the guess{} lead to no path that solves the equations of {} ({}); {}",
        iterations_, guide.converged() ? " and from an extremal without the scheme" : "",
        options_.scheme->name, first.message,
        guide.converged() ? "leave the scheme out, or try another scheme or guess"
                          : "without the scheme: " + guide.message);
    return first;
  }
  Solution told(Solution solution, std::string strategy) const {
    solution.strategy = std::move(strategy);
    solution.iterations = iterations_ + of_guide_;
    return solution;
  }

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  const std::function<Solution(const Problem&, const Outcome&)>& judge_;
  int iterations_ = 0, of_guide_ = 0;  ///< of the scheme, and of the solution without
  bool astray_ = false;
};

}  // namespace

SolveOptions for_guesses(const SolveOptions& options) {
  SolveOptions own = options.adaptive();
  own.deadline = options.deadline.share(search_share);
  return own;
}

Solution solve_with_scheme(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                           const std::function<Solution(const SolveOptions&)>& solve_freely,
                           const std::function<Solution(const Problem&, const Outcome&)>& judge) {
  SchemeSolve solve(problem, options, workspace, judge);
  Solution solution = solve.from_guess();
  return solve.astray() ? solve.from_others(std::move(solution), solve_freely(for_guesses(options)))
                        : solution;
}

}  // namespace extremal
