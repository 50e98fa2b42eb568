#pragma once

#include "action/rule.hpp"

/// \file The Lagrange polynomials of an element at one point, in double.

namespace extremal {

/// φ_0 … φ_s of the Lobatto nodes at τ, by the barycentric formula.
inline void nodal_values(int degree, double tau, double* value) {
  constexpr double nothing = 1e-290;  // from a node: its own weight is then all there is
  const Barycentric& element = lobatto_barycentric(degree);
  double sum = 0;
  for (int j = 0; j <= degree; ++j) {
    const double distance = tau - element.nodes[j];
    value[j] = element.weights[j] / (distance == 0 ? nothing : distance);
    sum += value[j];
  }
  for (int j = 0; j <= degree; ++j) value[j] /= sum;
}

}  // namespace extremal
