#include "study/phase.hpp"

#include <algorithm>

#include "problem/manifold.hpp"
#include "solution/columns.hpp"

namespace extremal {

void phase_point(const Problem& problem, const Trajectory& trajectory, double t, std::span<double> q,
                 std::span<double> v, std::span<double> p, Scratch& scratch) {
  if (problem.phase) {
    const std::size_t n = problem.degrees_of_freedom();
    std::vector<double> state(2 * n), rate(2 * n);
    trajectory.at(t, state, rate);
    std::copy_n(state.begin(), n, q.begin());
    std::copy_n(rate.begin(), n, v.begin());
    std::copy_n(state.begin() + static_cast<std::ptrdiff_t>(n), n, p.begin());
    return;
  }
  trajectory.at(t, q, v);
  if (problem.manifold) {
    problem.manifold->project(q, t);
    problem.manifold->make_tangent(q, t, v);
  }
  const Lagrangian& lagrangian = problem.manifold ? problem.manifold->lagrangian() : *problem.lagrangian;
  const PointValues values = evaluate_at(lagrangian, q, v, t, Order::gradient, scratch);
  std::copy(values.dv.begin(), values.dv.end(), p.begin());
}

namespace {

/// Of the state (q, p), the rates of p left out.
void state_columns(const Trajectory& trajectory, std::span<const double> times, std::span<double* const> q,
                   std::span<double* const> v, std::span<double* const> p) {
  const std::size_t n = q.size();
  std::vector<double*> state(q.begin(), q.end()), rate(v.begin(), v.end());
  std::vector<double> unused((p.empty() ? 2 : 1) * n * times.size());
  for (std::size_t a = 0; a < n; ++a) {
    rate.push_back(unused.data() + a * times.size());
    state.push_back(p.empty() ? unused.data() + (n + a) * times.size() : p[a]);
  }
  evaluate_columns(trajectory, times, state, rate);
}

/// Each point is put on the manifold.
void manifold_columns(const Problem& problem, const Trajectory& trajectory, std::span<const double> times,
                      std::span<double* const> q, std::span<double* const> v, std::span<double* const> p) {
  const std::size_t n = q.size();
  std::vector<double> point(n), rate(n), momentum(n);
  Scratch scratch;
  for (std::size_t i = 0; i < times.size(); ++i) {
    phase_point(problem, trajectory, times[i], point, rate, momentum, scratch);
    for (std::size_t a = 0; a < n; ++a) {
      q[a][i] = point[a];
      v[a][i] = rate[a];
      if (!p.empty()) p[a][i] = momentum[a];
    }
  }
}

}  // namespace

void phase_columns(const Problem& problem, const Trajectory& trajectory, std::span<const double> times,
                   std::span<double* const> q, std::span<double* const> v, std::span<double* const> p) {
  if (problem.phase) return state_columns(trajectory, times, q, v, p);
  if (problem.manifold) return manifold_columns(problem, trajectory, times, q, v, p);
  evaluate_columns(trajectory, times, q, v);
  if (p.empty()) return;
  const std::vector<const double*> at_q(q.begin(), q.end()), at_v(v.begin(), v.end());
  momentum_columns(*problem.lagrangian, times, at_q, at_v, p);
}

std::vector<std::string> coordinate_names(const Problem& problem) {
  return {problem.names.begin(), problem.names.begin() + problem.degrees_of_freedom()};
}

std::vector<double> constraint_forces(const Problem& problem, std::span<const double> q,
                                      std::span<const double> v, double t) {
  if (!problem.manifold) return {};
  return problem.manifold->multipliers(q, t, v);
}

}  // namespace extremal
