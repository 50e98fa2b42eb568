#include "solve/solve.hpp"

#include <algorithm>
#include <chrono>

#include "solve/distinct.hpp"
#include "solve/finish.hpp"
#include "solve/pinned.hpp"
#include "solve/search.hpp"
#include "solve/several.hpp"

namespace extremal {

namespace {

using Clock = std::chrono::steady_clock;

/// The problem, guessed by what solves it.
Problem guessed_by(const Problem& problem, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = problem.coordinates();
  Problem result = problem;
  result.duration.value = trajectory.duration();
  result.guess = {};
  std::vector<double> q(n), v(n);
  const int points = trajectory.degree * trajectory.elements();
  for (int k = 0; k <= points; ++k) {
    const double tau = static_cast<double>(k) / points;
    trajectory.at(tau * trajectory.duration(), q, v);
    result.guess.tau.push_back(tau);
    result.guess.q.insert(result.guess.q.end(), q.begin(), q.end());
  }
  return result;
}

}  // namespace

struct Solver::Memory {
  Workspace workspace;
  SecondVariation variation;
};

Solver::Solver() : memory_(std::make_unique<Memory>()) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

Solution Solver::solve(const Problem& problem, const SolveOptions& options) {
  Workspace& w = memory_->workspace;
  const auto start = Clock::now();
  w.levels.bind(problem.lagrangian);
  std::vector<Iteration> history;
  history.reserve(32);
  SolveOptions recording = options;
  recording.progress = [&](const Iteration& step) {
    history.push_back(step);
    if (options.progress) options.progress(step);
  };
  const Outcome outcome =
      options.scheme ? PinnedSolve(problem, recording, w).run() : Search(problem, recording, w).run();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  Solution solution = finish(problem, options, outcome, w, memory_->variation);
  solution.history = std::move(history);
  solution.seconds_solve = seconds;
  return solution;
}

std::vector<Solution> Solver::solve_all(const Problem& problem, const SolveOptions& options, int most) {
  Workspace& w = memory_->workspace;
  w.levels.bind(problem.lagrangian);
  SolveOptions adaptive = options;
  adaptive.scheme.reset();
  adaptive.elements = 0;
  std::vector<Solution> found = Several(problem, adaptive, w, memory_->variation).run(most);
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

}  // namespace extremal
