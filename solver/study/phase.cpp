#include "study/phase.hpp"

#include <algorithm>

#include "problem/manifold.hpp"

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

std::vector<std::string> coordinate_names(const Problem& problem) {
  return {problem.names.begin(), problem.names.begin() + problem.degrees_of_freedom()};
}

std::vector<double> constraint_forces(const Problem& problem, std::span<const double> q,
                                      std::span<const double> v, double t) {
  if (!problem.manifold) return {};
  return problem.manifold->multipliers(q, t, v);
}

}  // namespace extremal
