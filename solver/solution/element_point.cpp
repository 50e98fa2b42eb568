#include "solution/element_point.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

/// Lagrange's formula on the differences from the node that counts most: a constant costs no digits, and at a
/// node its own value comes out.
void element_point(const Trajectory& trajectory, int k, const Basis& basis, int point, double* q, double* v,
                   std::ptrdiff_t stride) {
  const int s = trajectory.degree, n = trajectory.coordinates;
  const double* const value = basis.value.data() + point * (s + 1);
  const double* const derivative = basis.derivative.data() + point * (s + 1);
  const double* const nodes = trajectory.nodes.data() + static_cast<std::ptrdiff_t>(k) * (s + 1) * n;
  const auto smaller = [](double x, double y) { return std::abs(x) < std::abs(y); };
  const double* const reference = nodes + (std::max_element(value, value + s + 1, smaller) - value) * n;
  const double h = trajectory.times[k + 1] - trajectory.times[k];
  for (int a = 0; a < n; ++a) {
    double change = 0, slope = 0;
    for (int j = 0; j <= s; ++j) {
      const double difference = nodes[j * n + a] - reference[a];
      change += value[j] * difference;
      slope += derivative[j] * difference;
    }
    q[a * stride] = reference[a] + change;
    v[a * stride] = slope / h;
  }
}

}  // namespace extremal
