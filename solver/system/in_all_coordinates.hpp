#pragma once

#include "system/chart.hpp"
#include "system/constraints.hpp"
#include "system/expression_matrix.hpp"

/// \file A constrained system in all coordinates y = (u, w) of a chart: system/minimal_expressions.hpp.

namespace extremal {

/// L, g and F in y, and their derivatives. Inputs of the graph are y, y', t, then μ, then ν.
struct InAllCoordinates {
  using Row = expression_matrix::Row;
  using Matrix = expression_matrix::Matrix;

  InAllCoordinates(const ConstrainedGraph& system, const Chart& chart);

  /// Whether L or the constraints read t, and whether forces do.
  bool timed();
  bool timed_forces();
  /// ∂f by `count` inputs from `from` on.
  Row slopes(Scaled f, int from, int count);

  Graph graph;
  Algebra algebra;
  const int n, d, m;
  Scaled lagrangian;
  Row g, g_t, rates;   ///< rates: g'
  Matrix g_y, rate_y;  ///< m × n
  Row lagrangian_z;    ///< by (y, y')
  Row first;           ///< of F = L + μ·g + ν·g' by (y, y')
  Matrix second;       ///< lower triangle
  Row force;           ///< the covector (∂q/∂y)ᵀ F of the forces; empty: there are none
  Matrix force_z;      ///< by (y, y')

 private:
  Row inputs_of_system(const ConstrainedGraph& system, const Chart& chart, int constraint);
  void put_polar(const Polar& p, bool at_zero, Row& z);
  void put_forces(const ConstrainedGraph& system, const Chart& chart);
};

}  // namespace extremal
