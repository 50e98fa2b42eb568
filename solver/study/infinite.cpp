#include "study/infinite.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "problem/infinite_ends.hpp"
#include "study/checks/checks.hpp"

namespace extremal {

namespace {

constexpr int most_slowings = 10;

/// A guess whose infinite ends are this near to their equilibria, relative to its range, reaches them; where
/// twice the time does not bring them so much nearer it is no guess that approaches them.
constexpr double reached = 0.02, nearer = 0.5;
constexpr int most_doublings = 8;

/// The largest distance of an infinite end of the guess from its equilibrium, relative to the range of the
/// guess.
double distance_from_rest(const Problem& problem, const InfiniteEnds& infinite) {
  const std::size_t n = problem.coordinates();
  const std::vector<double>& q = problem.guess.q;
  double range = 0, distance = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double low = q[a], high = low;
    for (std::size_t k = a; k < q.size(); k += n) {
      low = std::min(low, q[k]);
      high = std::max(high, q[k]);
    }
    range = std::max(range, high - low);
    if (!infinite.start.empty()) distance = std::max(distance, std::abs(q[a] - infinite.start[a]));
    if (!infinite.end.empty()) distance = std::max(distance, std::abs(q[q.size() - n + a] - infinite.end[a]));
  }
  return distance == 0 ? 0 : distance / range;
}

/// Where the scene gives the end that an error is about.
[[noreturn]] void refuse(const BoundaryTable& boundary, const InfiniteEndError& e) {
  using About = InfiniteEndError::About;
  if (e.about == About::start && !boundary.start.empty())
    throw SceneError(boundary.start.front().name_at, e.what());
  if (e.about == About::end && !boundary.end.empty())
    throw SceneError(boundary.end.front().name_at, e.what());
  throw SceneError(boundary.duration.at, e.what());
}

}  // namespace

InfiniteEnds read_infinite_ends(const Scene& scene, Purpose purpose, Problem& problem) {
  if (purpose == Purpose::comparison)
    throw SceneError(scene.boundary.duration.at,
                     "with an infinite duration shooting is not available to compare with; give a number, or "
                     "write 'solve' instead");
  if (problem.initial)
    throw SceneError(
        scene.boundary.duration.at,
        "'start' gives initial data, every coordinate and every momentum: the motion is determined, "
        "and needs a duration that is a number");
  try {
    InfiniteEnds infinite = infinite_ends(*problem.lagrangian, problem.ends, problem.names);
    problem.duration.value = approach_time(*problem.lagrangian, infinite);
    return infinite;
  } catch (const InfiniteEndError& e) {
    refuse(scene.boundary, e);
  }
}

void reach_equilibria(const Scene& scene, const InfiniteEnds& infinite,
                      const std::function<void(Problem& problem)>& put_guess, Problem& problem) {
  if (scene.guess.duration || !problem.guess.given()) return;
  double distance = distance_from_rest(problem, infinite);
  for (int k = 0; k < most_doublings && distance > reached; ++k) {
    Problem longer = problem;
    longer.guess = {};
    longer.duration.value *= 2;
    put_guess(longer);
    const double next = distance_from_rest(longer, infinite);
    if (!(next < nearer * distance)) break;
    distance = next;
    problem = std::move(longer);
  }
}

void leave_infinite_ends(const Scene& scene, InfiniteEnds infinite, Problem& problem) {
  const bool by_default = !problem.guess.given();
  try {
    make_infinite(problem, std::move(infinite));
    // Velocities may be bounded, as that of light. The default guess then takes its way in a longer time.
    for (int k = 0; by_default && k < most_slowings && !is_finite_on_guess(problem); ++k)
      problem.duration.value *= 2;
  } catch (const InfiniteEndError& e) {
    refuse(scene.boundary, e);
  }
}

}  // namespace extremal
