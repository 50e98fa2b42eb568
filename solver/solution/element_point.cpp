#include "solution/element_point.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

/// Lagrange's formula on the differences from the node that counts most: a constant costs no digits, and at a
/// node its own value comes out.
void element_point(const Trajectory& trajectory, int k, const Basis::Row& basis, double* q, double* v,
                   std::ptrdiff_t stride) {
  const int s = trajectory.degree, n = trajectory.coordinates;
  const auto [value, derivative] = basis;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(k) * (s + 1) * n;
  const double* const nodes = trajectory.nodes.data() + first;
  const double* const slopes = trajectory.slopes.empty() ? nullptr : trajectory.slopes.data() + first;
  const auto smaller = [](double x, double y) { return std::abs(x) < std::abs(y); };
  const std::ptrdiff_t reference = (std::max_element(value, value + s + 1, smaller) - value) * n;
  if (slopes && value[reference / n] == 1) {
    for (int a = 0; a < n; ++a) {
      q[a * stride] = nodes[reference + a];
      v[a * stride] = slopes[reference + a];
    }
    return;
  }
  const double h = trajectory.length(k);
  for (int a = 0; a < n; ++a) {
    const double q0 = nodes[reference + a], v0 = slopes ? slopes[reference + a] : 0;
    double change = 0, slope = 0;
    for (int j = 0; j <= s; ++j) {
      const double difference = nodes[j * n + a] - q0;
      change += value[j] * difference;
      slope += slopes ? value[j] * (slopes[j * n + a] - v0) : derivative[j] * difference / h;
    }
    q[a * stride] = q0 + change;
    v[a * stride] = v0 + slope;
  }
}

}  // namespace extremal
