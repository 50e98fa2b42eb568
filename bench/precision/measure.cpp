#include "measure.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "rivals/shooting.hpp"

namespace bench {
namespace {

constexpr int most_repeats = 2001;
constexpr int warm_repeats = 3;
/// A solve that takes longer is not repeated.
constexpr double slow = 0.5;

/// How often `seconds` fit into the budget; odd, so that the median is one of the times.
int affordable(double budget, double seconds) {
  return static_cast<int>(std::clamp(budget / seconds, 1.0, double(most_repeats))) | 1;
}

extremal::Solution solve_often(const extremal::Study& study, double budget, int& repeats) {
  const auto whole = [](const extremal::Solution& s) { return s.seconds_solve + s.seconds_analyse; };
  extremal::Solution solution = extremal::run(study);
  repeats = 1;
  if (whole(solution) > slow) return solution;
  solution = extremal::run(study, repeats = warm_repeats);
  const int more = affordable(budget, whole(solution));
  return more > repeats ? extremal::run(study, repeats = more) : solution;
}

/// Components of the state with all its variations above which single shooting is hopelessly slow.
constexpr int most_components = 10000;
/// The integrator of a shot is asked for this much more than the ends (see ShootingOptions).
constexpr double integrator_margin = 0.1;

Run shoot_often(const extremal::Problem& problem, double tolerance, const Reference& reference,
                double budget) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  extremal::Shot shot;
  double spent = 0;
  do {
    const auto start = Clock::now();
    shot = extremal::shoot(problem, {.tolerance = tolerance});
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    spent += seconds.back();
  } while (spent < budget && seconds.size() < most_repeats);
  std::nth_element(seconds.begin(), seconds.begin() + seconds.size() / 2, seconds.end());
  Run run{.tolerance = tolerance, .failure = shot.message, .seconds = seconds[seconds.size() / 2]};
  if (shot.status != extremal::Status::converged) return run;
  const std::span<const double> start(problem.ends.offset.data(), problem.coordinates());
  const extremal::Flight flight = extremal::fly(*problem.lagrangian, start, shot.velocity_start, reference.t,
                                                integrator_margin * tolerance);
  run.failure = flight.complete ? "" : "the trajectory found cannot be integrated";
  run.error = difference(flight.q, flight.v, reference).q;
  return run;
}

}  // namespace

Cell measure(extremal::Study study, double tolerance, const Reference& reference, double budget) {
  study.options.tolerance = tolerance;
  Cell cell;
  cell.tolerance = tolerance;
  cell.allowed = tolerance * reference.range;
  const extremal::Solution solution = solve_often(study, budget, cell.repeats);
  cell.seconds = solution.seconds_solve;
  cell.iterations = solution.iterations;
  cell.failure = solution.converged() ? "" : solution.message;
  if (!solution.converged()) return cell;
  cell.elements = solution.trajectory.elements();
  cell.degree = solution.trajectory.degree;
  cell.unknowns = solution.unknowns;
  cell.estimate = solution.error_estimate;
  const Difference apart = difference(solution.trajectory, reference);
  cell.error = apart.q;
  cell.velocity_error = apart.v / reference.velocity_range;
  return cell;
}

Rival measure_shooting(const extremal::Problem& problem, const Reference& reference, double budget) {
  Rival rival;
  const int n = problem.coordinates(), components = 2 * n * (n + 1);
  if (problem.ends.free > 0 || problem.duration.free)
    rival.absence = "needs both ends and the duration fixed";
  else if (components > most_components)
    rival.absence = fmt::format("would integrate {} components", components);
  if (!rival.absence.empty()) return rival;
  for (int digits = 4; digits <= 12; ++digits)
    rival.runs.push_back(shoot_often(problem, std::pow(10.0, -digits), reference, budget));
  return rival;
}

}  // namespace bench
