#include "solve/mesh/frequency.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// A light particle in a strong field is the fast one.
double lightest_mass(const Structure& s) {
  double lightest = INFINITY;
  for (const Triplet& m : s.mass)
    if (m.row == m.column) lightest = std::min(lightest, std::abs(m.value));
  return std::isfinite(lightest) ? lightest : 1;
}

/// Sizes of L_qq against L_q'q' in one point: rows of the remainder with a stride.
double squared_frequency(const Structure& s, double lightest, const double* hessian, std::size_t stride) {
  const int n = s.coordinates;
  double force = 0, inertia = 0;
  for (std::size_t e = 0; e < s.hessian.size(); ++e) {
    const double size = std::abs(hessian[e * stride]);
    if (s.hessian[e].row < n) force = std::max(force, size);
    if (s.hessian[e].column >= n && s.hessian[e].row == s.hessian[e].column)
      inertia = std::max(inertia, size);
  }
  if (s.quadratic) inertia = lightest;
  return inertia > 0 ? force / inertia : 0;
}

}  // namespace

void Frequency::add(double tau, double omega) {
  if (!std::isfinite(omega)) {
    finite_ = false;
    omega = density_.empty() ? 0 : density_.last();
  }
  density_.add(tau, omega);
}

void measure_frequency(const Problem& problem, DiscreteAction& action, const ElementTables& tables,
                       const Path& path, Frequency& frequency) {
  const Structure& s = problem.lagrangian->structure();
  const int points = tables.shape().points, lanes = path.lanes();
  const std::size_t stride = static_cast<std::size_t>(points) * lanes;
  const double lightest = lightest_mass(s);
  frequency.clear();
  frequency.set_duration(path.duration());
  for (int b = 0; b < path.batches(); ++b) {
    if (action.deadline().passed()) return frequency.add(0, NAN);
    const double* hessian = action.rows(path, b, Order::hessian) + (1 + s.gradient.size()) * stride;
    for (int lane = 0; lane < std::min(lanes, path.elements() - b * lanes); ++lane) {
      const double from = path.mesh()[b * lanes + lane], to = path.mesh()[b * lanes + lane + 1];
      for (int i = 0; i < points; ++i)
        frequency.add(from + tables.scheme().node[i] * (to - from),
                      std::sqrt(squared_frequency(s, lightest, hessian + i * lanes + lane, stride)));
    }
  }
}

}  // namespace extremal
