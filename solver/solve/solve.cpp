#include "solve/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "machine/clock.hpp"
#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "problem/singular_times.hpp"
#include "solution/extension_values.hpp"
#include "solution/guessed_by.hpp"
#include "solution/on_manifold.hpp"
#include "solution/one_copy.hpp"
#include "solve/accept/acceptance.hpp"
#include "solve/bordered/bordered_solve.hpp"
#include "solve/contact/contact_solve.hpp"
#include "solve/infinite_solve.hpp"
#include "solve/leg_solve.hpp"
#include "solve/march/initial_motion.hpp"
#include "solve/minimal_solve.hpp"
#include "solve/periodic/reconstruct_orbit.hpp"
#include "solve/phase_space_solve.hpp"
#include "solve/reversed_solve.hpp"
#include "solve/scheme_solve.hpp"
#include "solve/search/distinct.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/search.hpp"
#include "solve/search/several.hpp"
#include "solve/singular_solve.hpp"
#include "system/deferred_lagrangian.hpp"
#include "system/minimal_lagrangian.hpp"

namespace extremal {

namespace {

/// The largest of the values that a problem with an extension gives.
double given_size(const Problem& problem) {
  double size = 0;
  const auto take = [&](double x) { size = std::max(size, std::abs(x)); };
  std::ranges::for_each(problem.ends.offset, take);
  std::ranges::for_each(problem.guess.q, take);
  for (const WaypointCondition& waypoint : problem.extension->waypoints)
    for (const auto& [coordinate, value] : waypoint.fixed) take(value);
  return size;
}

/// Which solutions of a problem with an extension count as one.
std::function<bool(const Solution&, const Solution&)> same_of(const Problem& problem, double tolerance) {
  const bool orbits = problem.periodic && problem.shifts_in_time();
  return [orbits, size = given_size(problem), tolerance](const Solution& a, const Solution& b) {
    if (orbits) return same_orbit(a, b, tolerance);
    return same_path(a, b, tolerance, size) || same_continuum(a, b, tolerance);
  };
}

/// Newton's method on the part of an orbit that its symmetries leave to be found, continued to the whole.
Outcome solve_part(const Reduction& reduction, const SolveOptions& options, Workspace& w) {
  Search search(reduction.part, options, w);
  search.run_near_guess();
  Outcome outcome = search.take();
  if (outcome.status != Status::converged) return outcome;
  outcome.reduction = &reduction;
  outcome.message += fmt::format(" on 1/{} of the orbit, which symmetries continue", reduction.parts());
  std::swap(outcome.part, outcome.path);
  std::swap(outcome.path, w.spare_whole);
  reconstruct_orbit(reduction, outcome.part, *outcome.tables, outcome.path);
  return outcome;
}

/// The solution that a path is, or why there is none; found since `start`.
Solution judged(const Problem& problem, const SolveOptions& options, const Outcome& outcome, Workspace& w,
                Clock::time_point start) {
  const double seconds = seconds_since(start);
  Solution solution = outcome.status == Status::converged ? accept(problem, options, outcome, w)
                                                          : explain_failure(problem, options, outcome, w);
  solution.seconds_solve = seconds;
  return solution;
}

/// The orbit by its part; nothing where the whole is to be searched for. `spent` becomes the steps taken.
std::optional<Solution> solve_by_part(const Problem& problem, const SolveOptions& options, Workspace& w,
                                      Clock::time_point start, int& spent) {
  const Reduction& reduction = *problem.reduction;
  Outcome outcome = solve_part(reduction, options, w);
  spent = outcome.iterations;
  // If roundoff hides an extremal on its part, so it does on the whole.
  if (outcome.hidden) return judged(reduction.part, options, outcome, w, start);
  if (outcome.status != Status::converged) return std::nullopt;
  std::optional<Solution> solution = judged(problem, options, outcome, w, start);
  std::swap(outcome.part, w.spare);
  std::swap(outcome.path, w.spare_whole);
  return solution->converged() ? std::move(solution) : std::nullopt;
}

/// What lies between two rests is held in time by the energy, the square of deviations from rest. A looser
/// tolerance than this leaves its place open.
SolveOptions isolating(const SolveOptions& options) {
  SolveOptions closer = options;
  closer.tolerance = Acceptance::isolating_tolerance;
  return closer;
}

/// As the options ask: with a scheme of their own, by the part of a symmetric orbit, or by a search.
Solution solve_once(const Problem& problem, const SolveOptions& options, Workspace& w) {
  if (problem.initial) return solve_initial(problem, options);
  const auto start = Clock::now();
  w.levels.bind(problem.lagrangian);
  if (options.scheme)
    return solve_with_scheme(
        problem, options, w, [&](const SolveOptions& how) { return solve_once(problem, how, w); },
        [&](const Problem& given, const Outcome& found) { return judged(given, options, found, w, start); });
  int spent = 0;
  if (problem.reduction)
    if (std::optional<Solution> solution = solve_by_part(problem, options, w, start, spent))
      return *std::move(solution);
  Acceptance acceptance(problem, options, w);
  Search search(problem, options, w);
  const Outcome& last = search.run(&acceptance);
  const double seconds = seconds_since(start) - acceptance.seconds();
  Solution solution = acceptance.result(last);
  solution.seconds_solve = seconds;
  solution.iterations += spent;
  if (!acceptance.too_loose()) return solution;
  Solution closer = solve_once(problem, isolating(options), w);
  if (!closer.converged()) closer.message = std::move(solution.message);
  closer.iterations += solution.iterations;
  closer.seconds_solve += solution.seconds_solve;
  return closer;
}

/// A problem of finite duration, from the guess alone where `near_guess` holds.
Solution solve_finite(const Problem& problem, const SolveOptions& options, Workspace& w, bool near_guess) {
  if (!near_guess || options.scheme) return solve_once(problem, options, w);
  const auto start = Clock::now();
  w.levels.bind(problem.lagrangian);
  Search search(problem, options, w);
  search.run_near_guess();
  Outcome outcome = search.take();
  Solution solution = judged(problem, options, outcome, w, start);
  std::swap(outcome.path, w.spare);
  return solution;
}

/// In variables in which ends are regular where L is infinite.
Solution solve_singular(const Problem& problem, const EndVariables& variables, const SolveOptions& options,
                        Workspace& w) {
  const auto at_given_duration = [&](const Problem& fixed) {
    EndVariables there = variables;
    there.duration = fixed.duration.value;
    return in_time(fixed, there, solve_once(smoothed(fixed, there), options, w));
  };
  return problem.duration.free ? solve_for_duration(problem, options, at_given_duration)
                               : at_given_duration(problem);
}

/// Where the action is infinite there is nothing to solve for. At a loose end an extremal would have to begin
/// with the very value that is given: one attempt shows whether it does.
Solution solve_with_singular_time(const Problem& problem, const SingularTime& time,
                                  const SolveOptions& options, Workspace& w) {
  Solution solution;
  solution.status = Status::no_solution_near;
  solution.message = infinite_action(time.at_end);
  if (time.kind == SingularTime::Kind::divergent) return solution;
  if (time.kind == SingularTime::Kind::slow) {
    solution.message = fmt::format(
        "the integral of L converges too slowly towards the {} to be known to a tolerance; weaken its "
        "singularity in t",
        time.at_end ? "end" : "start");
    return solution;
  }
  Solution attempt = solve_finite(problem, options, w, true);
  if (attempt.converged()) return attempt;
  solution.iterations = attempt.iterations;
  solution.seconds_solve = attempt.seconds_solve;
  const char* const end = time.at_end ? "end" : "start";
  solution.message = fmt::format(
      "the mass vanishes at the {} like the power {:.3g} of the time from it, so that no force holds a value "
      "there; leave the coordinates out of '{}', and those of the extremal are found",
      end, time.mass, end);
  return solution;
}

/// On the whole time axis, where ends are at infinity.
Solution solve_any(const Problem& problem, const SolveOptions& options, Workspace& w) {
  const std::vector<SingularTime> times = options.scheme || !problem.has_ends() || problem.copies
                                              ? std::vector<SingularTime>{}
                                              : singular_times(problem);
  if (!options.scheme)
    if (const std::optional<EndVariables> variables = singular_ends(problem, times))
      return solve_singular(problem, *variables, options, w);
  for (const SingularTime& time : times)
    if (time.kind != SingularTime::Kind::powers) return solve_with_singular_time(problem, time, options, w);
  if (!options.scheme && has_layer_at_end(problem))
    return reversed(problem, solve_once(reversed(problem), options, w));
  if (!problem.infinite) return solve_once(problem, options, w);
  return solve_infinite(problem, options,
                        [&w](const Problem& part, const SolveOptions& how, bool near_guess) {
                          return solve_finite(part, how, w, near_guess);
                        });
}

SolveOptions of_a_leg(const SolveOptions& options) {
  SolveOptions own = options.adaptive();
  own.progress = nullptr;
  return own;
}

/// The solutions of all legs as guess; nothing where one has none.
std::optional<Problem> guessed_by_legs(const Problem& problem, const SolveOptions& options, Workspace& w) {
  const std::optional<std::vector<LegProblem>> legs = separate_legs(problem);
  if (!legs) return std::nullopt;
  std::vector<Solution> found;
  std::vector<const Trajectory*> paths;
  found.reserve(legs->size());
  for (const LegProblem& leg : *legs) {
    found.push_back(leg.problem.extension ? solve_bordered(leg.problem, options)
                                          : solve_any(leg.problem, options, w));
    if (!found.back().converged()) return std::nullopt;
    paths.push_back(&found.back().trajectory);
  }
  return guessed_by_legs(problem, *legs, paths);
}

/// With an extension; where no guess of the whole leads to a solution, from those of its legs.
Solution solve_extended(const Problem& problem, const SolveOptions& options, Workspace& w) {
  Solution solution = solve_bordered(problem, options);
  if (solution.converged()) return solution;
  const std::optional<Problem> guessed = guessed_by_legs(problem, of_a_leg(options), w);
  if (!guessed) return solution;
  Solution found = solve_bordered(*guessed, options);
  if (!found.converged()) return solution;
  found.strategy = "legs between waypoints, each from the guess, then newton from there";
  found.iterations += solution.iterations;
  found.seconds_solve += solution.seconds_solve;
  return found;
}

/// From the guess alone, by the part of a symmetric orbit or the whole.
Solution solve_near_guess(const Problem& given, const SolveOptions& how, Workspace& w) {
  int spent = 0;
  if (given.reduction) {
    w.levels.bind(given.lagrangian);
    if (auto solution = solve_by_part(given, how, w, Clock::now(), spent)) return *std::move(solution);
  }
  Solution solution = solve_finite(given, how, w, true);
  solution.iterations += spent;
  return solution;
}

/// In phase space; from the guess alone first, by the part of a symmetric orbit or the whole.
Solution solve_phase_space(const Problem& problem, const SolveOptions& options, Workspace& w) {
  return solve_in_phase_space(problem, options,
                              [&w](const Problem& given, const SolveOptions& how, bool near_guess) {
                                if (!near_guess || given.initial || how.scheme)
                                  return solve_once(given, how, w);
                                return solve_near_guess(given, how, w);
                              });
}

/// Parts of paths under inequalities, each from its guess.
ArcSolve arc_solve(Workspace& w) {
  return [&w](const Problem& part, const SolveOptions& how) {
    SolveOptions quiet = how;
    quiet.progress = nullptr;
    Solution solution = part.extension ? solve_bordered(part, quiet) : solve_finite(part, quiet, w, true);
    if (part.manifold) move_onto_manifold(part, solution);
    return solution;
  };
}

/// The problem with the constants that were found, and what was found beside its path for one of the copies.
Problem with_found_constants(const Problem& problem, Solution& solution) {
  const Extension& extension = *problem.extension;
  auto values = std::make_shared<ExtensionValues>(*solution.extension);
  std::vector<double> constants;
  for (const auto& [name, value] : values->unknowns) constants.push_back(value);
  for (WaypointImpulse& waypoint : values->waypoints)
    std::erase_if(waypoint.impulse, [&](const auto& jump) { return jump.first >= problem.coordinates(); });
  Problem found = problem;
  found.lagrangian = values->lagrangian = extension.at(constants);
  found.copies = extension.copies_at(constants);
  solution.extension = std::move(values);
  return found;
}

/// With forces, given the solution of both copies.
Solution one_of_copies(const Problem& problem, Solution pair, const SolveOptions& options) {
  const Scheme* scheme = options.scheme ? &*options.scheme : nullptr;
  if (pair.extension) {
    const Problem found = with_found_constants(problem, pair);
    return one_copy(found, std::move(pair), scheme);
  }
  Solution solution = one_copy(problem, std::move(pair), scheme);
  if (problem.manifold) move_onto_manifold(problem, solution);
  return solution;
}

/// Whether minimal coordinates are those of a search too: angles have no limit.
bool searched_in_chart(const Problem& problem) {
  const Manifold::Parts& parts = problem.manifold->parts();
  return parts.only_minimal || (parts.minimal && !parts.minimal->lagrangian->chart().polar.empty());
}

/// On the manifold that the constants of a solution have.
void on_manifold_found(const Problem& problem, Solution& solution) {
  if (!solution.extension || !solution.extension->manifold) return move_onto_manifold(problem, solution);
  Problem found = problem;
  found.manifold = solution.extension->manifold;
  move_onto_manifold(found, solution);
}

}  // namespace

struct Solver::Memory {
  Workspace workspace;
};

Solver::Solver() : memory_(std::make_unique<Memory>()) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

Solution Solver::solve(const Problem& problem, const SolveOptions& options) {
  std::vector<Iteration> history;
  history.reserve(32);
  SolveOptions recording = options;
  recording.progress = [&](const Iteration& step) {
    history.push_back(step);
    if (options.progress) options.progress(step);
  };
  Workspace& w = memory_->workspace;
  if (problem.manifold && !problem.inequalities) {
    // One search is enough.
    const MinimalProblem* const searched =
        searched_in_chart(problem) ? problem.manifold->parts().minimal.get() : nullptr;
    const auto solve_there = [&](const MinimalProblem& in, const SolveOptions& how) {
      const Problem& solved = in.problem.pair ? *in.problem.pair : in.problem;
      const bool whole = problem.initial || &in == searched;
      Solution found = whole ? solve_once(solved, how, w) : solve_near_guess(solved, how, w);
      return in.problem.pair ? one_of_copies(in.problem, std::move(found), how) : found;
    };
    if (std::optional<Solution> solution = solve_minimal(problem, recording, solve_there)) {
      solution->history = std::move(history);
      return *std::move(solution);
    }
    history.clear();
  }
  if (problem.pair) return one_of_copies(problem, solve(*problem.pair, options), options);
  if (auto made = as_made(problem.lagrangian); made != problem.lagrangian) {
    Problem whole = problem;
    whole.lagrangian = std::move(made);
    return solve(whole, options);
  }
  Solution solution = problem.inequalities ? solve_with_inequalities(problem, recording, arc_solve(w))
                      : problem.extension  ? solve_extended(problem, recording, w)
                      : problem.phase      ? solve_phase_space(problem, recording, w)
                                           : solve_any(problem, recording, w);
  if (problem.manifold && !problem.inequalities) on_manifold_found(problem, solution);
  solution.history = std::move(history);
  return solution;
}

std::vector<Solution> Solver::solve_all(const Problem& problem, const SolveOptions& options, int most) {
  const bool single = problem.infinite || (problem.manifold && problem.manifold->parts().only_minimal);
  if (!problem.inequalities && (single || problem.initial || problem.phase)) return {solve(problem, options)};
  if (problem.pair) {
    std::vector<Solution> found = solve_all(*problem.pair, options, most);
    for (Solution& solution : found) solution = one_of_copies(problem, std::move(solution), options);
    sort_by_action(found);
    return found;
  }
  Workspace& w = memory_->workspace;
  if (auto made = as_made(problem.lagrangian); made != problem.lagrangian) {
    Problem whole = problem;
    whole.lagrangian = std::move(made);
    return solve_all(whole, options, most);
  }
  if (problem.inequalities) return minimisers(problem, options, most, arc_solve(w));
  if (problem.extension) {
    std::vector<Solution> found = combined_from_legs(problem, options, most);
    if (!found.empty()) return found;
    return solve_bordered_all(problem, options, most, same_of(problem, options.tolerance));
  }
  w.levels.bind(problem.lagrangian);
  const SolveOptions adaptive = options.scheme ? for_guesses(options) : options;
  Several several(problem, adaptive, w);
  std::vector<Solution> found = several.run(most);
  if (several.too_loose()) found = Several(problem, isolating(adaptive), w).run(most);
  if (problem.manifold && !options.scheme)
    for (Solution& solution : found) move_onto_manifold(problem, solution);
  if (!options.scheme || !found.front().converged()) return found;
  std::vector<Solution> discrete;
  for (const Solution& guess : found) {
    Solution solution = solve(guessed_by(problem, guess), options);
    const auto same = [&](const Solution& other) { return same_discrete(solution, other); };
    if (!solution.converged() || std::any_of(discrete.begin(), discrete.end(), same)) continue;
    solution.strategy = guess.strategy;
    discrete.push_back(std::move(solution));
  }
  if (discrete.empty()) return {solve(problem, options)};
  sort_by_action(discrete);
  return discrete;
}

/// Each leg's extremals are searched for by themselves; those of the whole are all combinations. Empty where
/// legs are not separate, or one has none.
std::vector<Solution> Solver::combined_from_legs(const Problem& problem, const SolveOptions& options,
                                                 int most) {
  const auto start = Clock::now();
  const std::optional<std::vector<LegProblem>> legs = separate_legs(problem);
  if (!legs) return {};
  std::vector<std::vector<Solution>> found;
  std::vector<std::vector<double>> actions;
  for (const LegProblem& leg : *legs) {
    found.push_back(solve_all(leg.problem, of_a_leg(options), most));
    std::erase_if(found.back(), [](const Solution& s) { return !s.converged(); });
    if (found.back().empty()) return {};
    std::vector<double>& of_leg = actions.emplace_back();
    for (const Solution& solution : found.back()) of_leg.push_back(solution.action);
  }
  std::vector<Solution> all;
  const auto same = same_of(problem, options.tolerance);
  const std::vector<std::vector<int>> combinations = least_combinations(actions, most);
  for (const std::vector<int>& numbers : combinations) {
    std::vector<const Trajectory*> paths;
    for (std::size_t k = 0; k < numbers.size(); ++k)
      paths.push_back(&found[k][static_cast<std::size_t>(numbers[k])].trajectory);
    Solution solution = solve_bordered(guessed_by_legs(problem, *legs, paths), options);
    const auto known = [&](const Solution& other) { return same(solution, other); };
    if (!solution.converged() || std::ranges::any_of(all, known)) continue;
    solution.strategy = "extremals of the legs between waypoints, then newton from there";
    solution.seconds_solve = seconds_since(start);
    all.push_back(std::move(solution));
  }
  sort_by_action(all);
  if (!all.empty())
    all.front().message += fmt::format(
        "; {} of up to {} extremals found, from {} combinations of those of the {} legs; more may exist",
        all.size(), most, combinations.size(), legs->size());
  return all;
}

}  // namespace extremal
