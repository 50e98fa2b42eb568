#include "report/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solution/path_contacts.hpp"
#include "study/phase.hpp"

namespace extremal {
namespace {

/// A picture has so many equal steps, and so many in each element; of elements that are many, fewer.
constexpr int plot_steps = 800, element_steps = 8, most_element_steps = 20'000;

/// Obstacles are drawn so far beside a path, in parts of the larger side of its box.
constexpr double beside_path = 1;

std::vector<double*> places(std::vector<Column>& columns) {
  std::vector<double*> places;
  for (Column& column : columns) places.push_back(column.data());
  return places;
}

/// Where L is infinite at an end, a solution has no momentum there, or one of its action alone.
void find_open_ends(const Solution& solution, Samples& samples) {
  const double duration = solution.duration();
  for (std::size_t k = 0; k < samples.count(); ++k) {
    const bool start = samples.t[k] == 0, end = samples.t[k] == duration;
    if (!start && !end) continue;
    const auto finite = [&](const Column& column) { return std::isfinite(column[k]); };
    const bool open = (start && solution.momentum_start.empty()) || (end && solution.momentum_end.empty()) ||
                      !std::ranges::all_of(samples.p, finite);
    if (!open) continue;
    (start ? samples.open_start : samples.open_end) = true;
    for (std::vector<Column>* part : {&samples.v, &samples.p})
      for (Column& column : *part) column[k] = std::numeric_limits<double>::quiet_NaN();
  }
}

/// Those of constraints and of inequalities.
void add_forces(const Problem& problem, const Solution& solution, Samples& samples) {
  const std::size_t n = samples.coordinates(), count = samples.count();
  if (solution.contacts) samples.path_forces.assign(solution.contacts->constraints, Column(count));
  std::vector<double> q(n), v(n);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t a = 0; a < n; ++a) {
      q[a] = samples.q[a][k];
      v[a] = samples.v[a][k];
    }
    std::vector<double> forces;
    if (problem.manifold && solution.contacts)
      forces = solution.contacts->constraint_forces(q, v, samples.t[k]);
    if (forces.empty()) forces = constraint_forces(problem, q, v, samples.t[k]);
    if (samples.constraint_forces.size() != forces.size())
      samples.constraint_forces.assign(forces.size(), Column(count));
    for (std::size_t i = 0; i < forces.size(); ++i) samples.constraint_forces[i][k] = forces[i];
    if (!solution.contacts) continue;
    const std::vector<double> path_forces = solution.contacts->forces(q, v, samples.t[k]);
    for (std::size_t i = 0; i < path_forces.size(); ++i) samples.path_forces[i][k] = path_forces[i];
  }
}

Samples drawn(const Problem& problem, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  std::vector<double> times = equal_times(plot_steps + 1, trajectory.duration());
  const int steps = std::min(element_steps, most_element_steps / trajectory.elements());
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int i = 0; i < steps; ++i)
      times.push_back(trajectory.times[k] + (trajectory.times[k + 1] - trajectory.times[k]) * i / steps);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  Samples samples = sample(problem, solution, times);
  bound_ends(samples);
  return samples;
}

bool in_equal_steps(const Column& t, double duration) {
  return t.size() > plot_steps && t == equal_times(static_cast<int>(t.size()), duration);
}

Samples drawn(const Problem& problem, const Result& result, bool saved) {
  if (!saved || !result.samples || !in_equal_steps(result.samples->t, result.solution.duration()))
    return drawn(problem, result.solution);
  Samples samples = *result.samples;
  bound_ends(samples);
  return samples;
}

}  // namespace

std::vector<double> equal_times(int count, double duration) {
  std::vector<double> times(count);
  for (int k = 0; k < count; ++k) times[k] = k + 1 == count ? duration : duration * k / (count - 1);
  return times;
}

Samples sample(const Problem& problem, const Solution& solution, const std::vector<double>& times) {
  const std::size_t n = problem.degrees_of_freedom();
  const auto columns = [&] { return std::vector<Column>(n, Column(times.size())); };
  Samples samples{times, columns(), columns(), columns()};
  phase_columns(problem, solution.trajectory, times, places(samples.q), places(samples.v), places(samples.p));
  if (problem.manifold || solution.contacts) add_forces(problem, solution, samples);
  find_open_ends(solution, samples);
  return samples;
}

Samples sampled(const Trajectory& trajectory, int count) {
  const std::size_t n = trajectory.coordinates;
  Samples samples{.t = equal_times(count, trajectory.duration()),
                  .q = std::vector<Column>(n, Column(count)),
                  .v = std::vector<Column>(n, Column(count)),
                  .p = {}};
  std::vector<double> q(n), v(n);
  for (int k = 0; k < count; ++k) {
    trajectory.at(samples.t[k], q, v);
    for (std::size_t a = 0; a < n; ++a) {
      samples.q[a][k] = q[a];
      samples.v[a][k] = v[a];
    }
  }
  return samples;
}

void add_spectrum(const Study& study, const SpectrumRequest& request, Result& result) {
  result.spectrum = spectrum_of(study, request, result.solution);
  result.solution.message += unresolved_lines(study, *result.spectrum, result.solution.duration());
}

void bound_ends(Samples& samples) {
  if (samples.count() < 2) return;
  for (std::vector<Column>* part : {&samples.v, &samples.p})
    for (Column& column : *part) {
      if (std::isnan(column.front())) column.front() = column[1];
      if (std::isnan(column.back())) column.back() = column[column.size() - 2];
    }
}

void add_surroundings(const Study& study, Result& result) {
  if (!result.solution.converged() || !result.samples) return;
  result.annotation = annotation(study);
  result.boundaries = obstacle_boundaries(study.problem, result.solution.trajectory, beside_path);
}

Picture picture_of(const Problem& problem, const Result& result, const Annotation& annotation, bool saved) {
  Picture picture{.title = result.title,
                  .names = result.names,
                  .samples = drawn(problem, result, saved),
                  .annotation = annotation};
  if (result.solution.contacts) {
    picture.contacts = result.solution.contacts->contacts;
    picture.obstacles = obstacle_boundaries(problem, result.solution.trajectory, beside_path);
  }
  const auto add_waypoints = [&](const Solution& solution) {
    if (!solution.extension || solution.extension->waypoints.empty()) return;
    picture.waypoints.push_back(solution.extension->waypoints);
  };
  if (!result.solutions || result.solutions->size() < 2) {
    add_waypoints(result.solution);
    return picture;
  }
  for (const Result& each : *result.solutions) {
    add_waypoints(each.solution);
    picture.actions.push_back(each.solution.action);
    if (picture.actions.size() > 1) picture.others.push_back(drawn(problem, each, saved));
  }
  return picture;
}

}  // namespace extremal
