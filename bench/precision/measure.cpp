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

/// Coordinates above which the variations of many segments take too long, and those of one.
constexpr int most_multiple = 40, most_single = 1000;
/// Tried, so that the best can be chosen in hindsight.
constexpr int segment_counts[] = {4, 8, 16, 32};

/// Largest error of the motion found, followed from segment to segment.
void measure_error(const extremal::Problem& problem, const extremal::Shot& shot, const Reference& reference,
                   Run& run) {
  std::vector<double> times = reference.t;
  for (double& t : times) t = std::min(t, shot.duration());
  extremal::Flight flight = extremal::follow(*problem.lagrangian, shot, times);
  run.failure = flight.complete ? "" : "the trajectory found cannot be followed";
  if (!flight.complete) return;
  const std::size_t n = problem.coordinates();
  for (std::size_t i = 0; i < flight.q.size(); ++i)
    flight.q[i] += (reference.t[i / n] - times[i / n]) * flight.v[i];
  run.error = difference(flight.q, flight.v, reference).q;
}

Run shoot_often(const extremal::Problem& problem, double tolerance, int segments, const Reference& reference,
                double budget) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  extremal::Shot shot;
  double spent = 0;
  do {
    const auto start = Clock::now();
    shot = extremal::shoot(problem, {.tolerance = tolerance, .segments = segments});
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    spent += seconds.back();
  } while (spent < budget && seconds.size() < most_repeats);
  std::nth_element(seconds.begin(), seconds.begin() + seconds.size() / 2, seconds.end());
  Run run{.tolerance = tolerance,
          .failure = shot.message,
          .segments = segments,
          .seconds = seconds[seconds.size() / 2]};
  if (shot.converged()) measure_error(problem, shot, reference, run);
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
  cell.degree = solution.degree;
  cell.unknowns = solution.unknowns;
  cell.estimate = solution.error_estimate;
  const Difference apart = difference(solution.trajectory, reference);
  cell.error = apart.q;
  cell.velocity_error = apart.v / reference.velocity_range;
  return cell;
}

void measure_shooting(const extremal::Problem& problem, const Reference& reference, double budget,
                      SceneRecord& record) {
  const int n = problem.coordinates();
  const auto refuse = [n](Rival& rival) { rival.absence = fmt::format("not tried with {} coordinates", n); };
  if (n > most_single) refuse(record.single);
  if (n > most_multiple) refuse(record.multiple);
  for (int digits = 3; digits <= 13; ++digits) {
    const double tolerance = std::pow(10.0, -digits);
    if (record.single.absence.empty())
      record.single.runs.push_back(shoot_often(problem, tolerance, 1, reference, budget));
    if (!record.multiple.absence.empty()) continue;
    for (const int segments : segment_counts)
      record.multiple.runs.push_back(shoot_often(problem, tolerance, segments, reference, budget));
  }
}

}  // namespace bench
