#include "study/phase.hpp"

#include <algorithm>

namespace extremal {

void phase_point(const Problem& problem, const Trajectory& trajectory, double t, std::span<double> q,
                 std::span<double> v, std::span<double> p, Scratch& scratch) {
  trajectory.at(t, q, v);
  const PointValues values = evaluate_at(*problem.lagrangian, q, v, t, Order::gradient, scratch);
  std::copy(values.dv.begin(), values.dv.end(), p.begin());
}

}  // namespace extremal
