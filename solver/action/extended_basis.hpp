#pragma once

#include <vector>

#include "action/real_rule.hpp"
#include "action/tables.hpp"

namespace extremal {

/// The quadrature and the Lagrange polynomials of an element with more digits than doubles have.
struct ExtendedBasis {
  Quadrature quadrature = Quadrature::lobatto;
  int degree = 0, points = 0;
  bool nodal = false;  ///< points are the nodes of the element
  RealRule rule;
  std::vector<DoubleDouble> value, slope;  ///< points × (s + 1): φ_j(c_i), φ_j'(c_i)

  /// Those of a scheme; the ones there are stay. False for a quadrature other than Lobatto's at the nodes,
  /// and Gauss's.
  bool bind(const SchemeTables& scheme);

  const DoubleDouble& node(int i) const { return rule.nodes[i].left; }
  const DoubleDouble& before_end(int i) const { return rule.nodes[i].right; }
  const DoubleDouble& weight(int i) const { return rule.weights[i]; }
};

}  // namespace extremal
