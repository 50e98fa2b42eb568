#pragma once

#include <vector>

/// \file A quadratic cost of an end that is free.

namespace extremal {

/// c(q) = p·(q − q*) + ½ (q − q*)ᵀ S (q − q*), added to the action: the natural condition of the end is then
/// ∂S_h/∂q = −∂c/∂q. Empty: no cost.
struct EndCost {
  std::vector<double> centre, slope;  ///< q* and p, n each
  std::vector<double> stiffness;      ///< S, n × n, symmetric

  bool given() const { return !centre.empty(); }
  /// c(q); adds ∂c/∂q, n entries, to `gradient`.
  double add(const double* q, double* gradient) const {
    const std::size_t n = centre.size();
    double value = 0;
    for (std::size_t a = 0; a < n; ++a) {
      double force = 0;
      for (std::size_t b = 0; b < n; ++b) force += stiffness[a * n + b] * (q[b] - centre[b]);
      value += (q[a] - centre[a]) * (slope[a] + 0.5 * force);
      gradient[a] += slope[a] + force;
    }
    return value;
  }
};

}  // namespace extremal
