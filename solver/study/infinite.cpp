#include "study/infinite.hpp"

#include <utility>

#include "problem/infinite_ends.hpp"
#include "study/checks.hpp"

namespace extremal {

namespace {

constexpr int most_slowings = 10;

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
