#include "problem/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "problem/copies.hpp"
#include "problem/extension.hpp"
#include "problem/own_symmetries.hpp"
#include "problem/phase_space.hpp"
#include "problem/recurrence.hpp"
#include "problem/reduction.hpp"

namespace extremal {

namespace {

template <class... Arguments>
void require(bool holds, fmt::format_string<Arguments...> message, Arguments&&... arguments) {
  if (!holds) throw std::invalid_argument(fmt::format(message, std::forward<Arguments>(arguments)...));
}

void check_dimensions(const Problem& problem) {
  require(problem.lagrangian != nullptr, "the problem has no Lagrangian");
  const int n = problem.lagrangian->structure().coordinates;
  require(n >= 1, "coordinates = {}; need at least 1", n);
  require(problem.coordinates() == n, "the boundary relation has {} coordinates, the Lagrangian {}",
          problem.coordinates(), n);
  require(problem.names.empty() || static_cast<int>(problem.names.size()) == n, "{} names for {} coordinates",
          problem.names.size(), n);
  require(problem.boundary.rows <= 2 * n, "{} boundary conditions for {} coordinates; at most {} can hold",
          problem.boundary.rows, n, 2 * n);
  require(!problem.periodic || problem.boundary.rows == n,
          "a periodic problem of {} coordinates has {} boundary conditions; need one for each coordinate", n,
          problem.boundary.rows);
}

void check_duration(const Problem& problem) {
  const Duration& duration = problem.duration;
  const bool autonomous = problem.motion().structure().autonomous;
  require(std::isfinite(duration.value) && duration.value > 0, "duration = {}; need a positive number",
          duration.value);
  const int closures = (duration.energy ? 1 : 0) + (duration.where ? 1 : 0);
  if (!duration.free) {
    if (problem.extension)
      require(static_cast<int>(problem.extension->where.size()) == problem.extension->unknowns(),
              "{} conditions close {} unknown constants; need as many", problem.extension->where.size(),
              problem.extension->unknowns());
    require(closures == 0, "the duration is fixed at {}; energy or where need a free duration",
            duration.value);
    return;
  }
  if (problem.extension) {
    const int wanted = problem.extension->unknowns() + (duration.energy ? 0 : 1);
    const int given = static_cast<int>(problem.extension->where.size());
    require(given == wanted, "{} conditions close {} unknown constants and the duration; need {}", given,
            problem.extension->unknowns(), wanted);
    require(autonomous, "a free duration needs a Lagrangian that does not depend on t");
    require(!problem.copies || !duration.energy, "with forces the energy varies; it closes no free duration");
    return;
  }
  require(!problem.copies || !duration.energy, "with forces the energy varies; it closes no free duration");
  if (problem.copies && problem.periodic)
    require(closures == 0, "with forces an orbit has a period of its own; nothing else closes it");
  else
    require(closures == 1, "a free duration needs exactly one of energy, where; {} given", closures);
  require(!duration.energy || std::isfinite(*duration.energy), "energy = {}; need a finite number",
          duration.energy.value_or(0));
  require(autonomous, "a free duration needs a Lagrangian that does not depend on t");
}

void check_copies(const Problem& problem) {
  if (!problem.copies) return;
  const int n = problem.coordinates(), found = problem.copies->structure().coordinates;
  require(found == 2 * n, "the Lagrangian of two copies has {} coordinates; need {}", found, 2 * n);
}

void check_guess(const Guess& guess, int coordinates) {
  if (!guess.given()) {
    require(guess.q.empty(), "the guess has {} values and no times", guess.q.size());
    return;
  }
  const std::size_t samples = guess.tau.size(), n = coordinates;
  require(guess.q.size() == samples * n, "the guess has {} values for {} times of {} coordinates",
          guess.q.size(), samples, n);
  require(samples >= 2, "the guess has {} samples; need at least 2", samples);
  require(guess.tau.front() == 0 && guess.tau.back() == 1, "the guess runs from {} to {} of T; need 0 to 1",
          guess.tau.front(), guess.tau.back());
  for (std::size_t k = 0; k < samples; ++k) {
    require(k == 0 || guess.tau[k] > guess.tau[k - 1],
            "times {} and {} of the guess, {} and {}, do not ascend", k, k + 1, k == 0 ? 0 : guess.tau[k - 1],
            guess.tau[k]);
    for (std::size_t a = 0; a < n; ++a)
      require(std::isfinite(guess.q[k * n + a]), "the guess is {} in coordinate {} at t/T = {}",
              guess.q[k * n + a], a + 1, guess.tau[k]);
  }
}

void check_initial(const Problem& problem) {
  if (!problem.initial) return;
  const std::size_t n = problem.coordinates();
  const auto& [q, p, paired] = *problem.initial;
  require(paired == problem.paired, "initial data are those of two copies of the coordinates or not");
  require(q.size() == n && p.size() == n, "initial data of {} coordinates and {} momenta; the system has {}",
          q.size(), p.size(), n);
  for (std::size_t a = 0; a < n; ++a)
    require(std::isfinite(q[a]) && std::isfinite(p[a]), "initial data {} and {} of coordinate {}", q[a], p[a],
            a + 1);
  require(!problem.periodic, "a periodic problem has no initial data");
  require(!problem.duration.free, "initial data need a duration that is a number");
}

/// L with all constants at their guesses may have symmetries that L + Σ ν g has not.
Problem at_other_multipliers(const Problem& problem) {
  constexpr double other = 0.37;
  const Extension& extension = *problem.extension;
  Problem result = problem;
  std::vector<double> constants = extension.guess;
  for (int j = 0; j < extension.multipliers(); ++j) constants.push_back(other + j / 7.0);
  result.lagrangian = extension.at(constants);
  return result;
}

void check_phase_space(const Problem& problem) {
  if (!problem.phase) return;
  require(problem.coordinates() % 2 == 0, "{} coordinates in phase space; need an even number",
          problem.coordinates());
  require(!problem.infinite, "H_pp is singular: ends at infinity are not available in phase space");
}

/// In phase space: with the Lagrangian that symmetries leave unchanged.
Problem without_squares(Problem problem) {
  problem.lagrangian = problem.phase->bare;
  return problem;
}

}  // namespace

bool Problem::shifts_in_time() const {
  if (!(periodic || (infinite && infinite->both())) || !lagrangian->structure().autonomous) return false;
  return !extension || std::ranges::all_of(extension->waypoints, &WaypointCondition::free);
}

Problem initial_problem(std::shared_ptr<const Lagrangian> lagrangian, InitialData initial, double duration) {
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = static_cast<int>(initial.q.size());
  for (int a = 0; a < problem.boundary.coordinates; ++a) problem.boundary.fix(a, false, initial.q[a]);
  problem.duration.value = duration;
  problem.initial = std::move(initial);
  return make_problem(std::move(problem));
}

Problem make_problem(Problem problem) {
  check_dimensions(problem);
  check_copies(problem);
  check_duration(problem);
  check_guess(problem.guess, problem.coordinates());
  check_initial(problem);
  problem.ends = solve_relation(problem.boundary);
  if (problem.copies) {
    problem.pair = std::make_shared<const Problem>(make_problem(pair_of(problem)));
    return problem;
  }
  if (problem.extension) {
    const Problem other = at_other_multipliers(problem);
    check_recurrence(other);
    problem.symmetries = own_symmetries(other);
    return problem;
  }
  check_phase_space(problem);
  const Problem invariant = problem.phase ? without_squares(problem) : problem;
  check_recurrence(invariant);
  problem.symmetries = own_symmetries(problem);
  if (!problem.paired) problem.reduction = reduction_of(problem);
  return problem;
}

}  // namespace extremal
