#include "study/guess/waypoint_times.hpp"

#include <cmath>
#include <functional>
#include <span>

#include "study/guess/closed_guess.hpp"

namespace extremal {

namespace {

/// Times that are compared.
constexpr int compared_times = 1024;
/// Of T: two waypoints are guessed to lie no nearer.
constexpr double least_apart = 1e-3;

using PathAt = std::function<void(double tau, std::span<double> q)>;

/// The first t/T between two at which a path of n coordinates is nearest to a waypoint.
double nearest_time(const PathAt& path, int n, const WaypointCondition& waypoint, double from, double to) {
  std::vector<double> q(n);
  double least = INFINITY, nearest = from;
  for (int i = 1; i < compared_times; ++i) {
    const double tau = from + least_apart + (to - from - 2 * least_apart) * i / compared_times;
    path(tau, q);
    double sum = 0;
    for (const auto& [a, x] : waypoint.fixed) sum += (q[a] - x) * (q[a] - x);
    if (sum < least) {
      least = sum;
      nearest = tau;
    }
  }
  return nearest;
}

}  // namespace

void time_by_guess(std::vector<WaypointCondition>& waypoints, const Problem& problem) {
  const PathAt path = [&](double tau, std::span<double> q) { problem.guess.at(tau, q); };
  double from = 0;
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    WaypointCondition& waypoint = waypoints[k];
    if (!waypoint.free) {
      from = waypoint.time / problem.duration.value;
      continue;
    }
    double to = 1;
    for (std::size_t j = k + 1; j < waypoints.size(); ++j)
      if (!waypoints[j].free) {
        to = waypoints[j].time / problem.duration.value;
        break;
      }
    from = waypoint.time = nearest_time(path, problem.coordinates(), waypoint, from, to);
  }
}

void begin_between(std::vector<WaypointCondition>& waypoints, Problem& problem) {
  const ClosedGuess guess(problem);
  const PathAt path = [&](double tau, std::span<double> q) { guess.at(tau, q); };
  const int n = problem.coordinates();
  // Up to one period before the guess, or after it.
  const double first = nearest_time(path, n, waypoints.front(), -1, 2);
  double last = first;
  for (WaypointCondition& waypoint : waypoints)
    waypoint.time =
        &waypoint == &waypoints.front() ? first : last = nearest_time(path, n, waypoint, last, first + 1);
  const double start = (first + last - 1) / 2;
  for (WaypointCondition& waypoint : waypoints) waypoint.time -= start;
  problem.guess = guess.from(start);
}

}  // namespace extremal
