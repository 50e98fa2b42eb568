#include "report/sampling.hpp"

#include <algorithm>

#include "solution/path_contacts.hpp"
#include "study/phase.hpp"

namespace extremal {
namespace {

/// A picture has so many equal steps, and so many in each element; of elements that are many, fewer.
constexpr int plot_steps = 800, element_steps = 8, most_element_steps = 20'000;

/// Obstacles are drawn so far beside a path, in parts of the larger side of its box.
constexpr double beside_path = 1;

Samples drawn(const Problem& problem, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  std::vector<double> times = equal_times(plot_steps + 1, trajectory.duration());
  const int steps = std::min(element_steps, most_element_steps / trajectory.elements());
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int i = 0; i < steps; ++i)
      times.push_back(trajectory.times[k] + (trajectory.times[k + 1] - trajectory.times[k]) * i / steps);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return sample(problem, solution, times);
}

}  // namespace

std::vector<double> equal_times(int count, double duration) {
  std::vector<double> times(count);
  for (int k = 0; k < count; ++k) times[k] = k + 1 == count ? duration : duration * k / (count - 1);
  return times;
}

Samples sample(const Problem& problem, const Solution& solution, const std::vector<double>& times) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = problem.degrees_of_freedom();
  const std::vector<Column> columns(n, Column(times.size()));
  Samples samples{times, columns, columns, columns};
  if (solution.contacts) samples.path_forces.assign(solution.contacts->constraints, Column(times.size()));
  std::vector<double> q(n), v(n), p(n);
  Scratch scratch;
  for (std::size_t k = 0; k < times.size(); ++k) {
    phase_point(problem, trajectory, times[k], q, v, p, scratch);
    for (std::size_t a = 0; a < n; ++a) {
      samples.q[a][k] = q[a];
      samples.v[a][k] = v[a];
      samples.p[a][k] = p[a];
    }
    const std::vector<double> forces = constraint_forces(problem, q, v, times[k]);
    if (samples.constraint_forces.size() != forces.size())
      samples.constraint_forces.assign(forces.size(), Column(times.size()));
    for (std::size_t i = 0; i < forces.size(); ++i) samples.constraint_forces[i][k] = forces[i];
    if (!solution.contacts) continue;
    const std::vector<double> path_forces = solution.contacts->forces(q, v, times[k]);
    for (std::size_t i = 0; i < path_forces.size(); ++i) samples.path_forces[i][k] = path_forces[i];
  }
  return samples;
}

Picture picture_of(const Problem& problem, const Result& result, const Annotation& annotation) {
  Picture picture{.title = result.title,
                  .names = result.names,
                  .samples = drawn(problem, result.solution),
                  .annotation = annotation};
  if (result.solution.contacts) {
    picture.contacts = result.solution.contacts->contacts;
    picture.obstacles = obstacle_boundaries(problem, result.solution.trajectory, beside_path);
  }
  if (!result.solutions || result.solutions->size() < 2) return picture;
  for (const Result& each : *result.solutions) {
    picture.actions.push_back(each.solution.action);
    if (picture.actions.size() > 1) picture.others.push_back(drawn(problem, each.solution));
  }
  return picture;
}

}  // namespace extremal
