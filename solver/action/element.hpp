#pragma once

#include "machine/simd.hpp"

/// \file The innermost loops of the method: a batch of elements, one in each lane. Plain data only,
/// because the same header serves the kernels of every instruction set.
///
/// In an element of length h, with τ in [0, 1], the trajectory is
///   q(τ) = q_a (1 − τ) + q_b τ + Σ_{0<j<s} d_j φ_j(τ),
/// φ_j the Lagrange polynomials of the inner Lobatto nodes. The deviations d_j from the chord are the
/// inner unknowns: they are O(h²), so what is computed from them does not cancel, and since
/// ∫ φ_j' = 0 the kinetic energy does not couple them to the ends.
/// Basis functions are numbered J = 0 … s: the s − 1 inner ones, then 1 − τ, then τ. The unknown (J, a)
/// has the local number J·n + a; m = (s + 1) n in all, of which the first (s − 1) n are inner.

namespace extremal {

/// Sparse sums over quadrature points: entry e of the table is Σ coefficient·(value at point) over
/// start[e] … start[e+1].
struct PointSums {
  const int* start;
  const int* point;
  const double* coefficient;
};

struct EntryView {
  int row, column;
  double value;
};

/// Scheme and structure as the kernels see them. Functions F = s + 1; pairs (J, K), K <= J, are numbered
/// J (J + 1)/2 + K, ordered pairs J F + K.
struct ElementShape {
  int n, functions, points;
  const double* node;       ///< c_i
  const double* weight;     ///< b_i
  const double* value;      ///< φ_J(c_i): [i*F + J]
  const double* slope;      ///< φ'_J(c_i)
  const double* stiffness;  ///< Σ b_i φ'_J φ'_K, F × F
  const double* gyration;   ///< Σ b_i φ'_J φ_K, F × F
  PointSums value_sum;      ///< b_i φ_J, an entry a function
  PointSums slope_sum;      ///< b_i φ'_J
  PointSums value_value;    ///< b_i φ_J φ_K, an entry a pair
  PointSums slope_value;    ///< b_i φ'_J φ_K, an entry an ordered pair
  PointSums slope_slope;    ///< b_i φ'_J φ'_K, an entry a pair
  bool nodal;               ///< the points are the Lobatto nodes: φ_j(c_i) = δ_ij for inner j

  // The Lagrangian: ½ q'ᵀMq' + q'ᵀCq + aᵀq' + R.
  int mass_count, gyroscopic_count, linear_count;
  const EntryView* mass;
  const EntryView* gyroscopic;
  const double* linear;
  bool velocity_free;  ///< R does not depend on q'
  int gradient_count, hessian_count;
  const int* gradient;       ///< z of each gradient row
  const EntryView* hessian;  ///< (z, z) of each Hessian row, value unused
};

/// A batch of elements: every pointer is to groups of one double for each lane. Inner unknowns first:
/// x[J*n + a] = d_j for inner J; then q_a; then Δ = q_b − q_a in place of q_b.
struct ElementBatch {
  const double* h;      ///< 1
  const double* start;  ///< 1: time at τ = 0
  const double* x;      ///< m
  double* q;            ///< n × points
  double* v;            ///< n × points, unused where velocity_free
  double* t;            ///< points, or null
  const double* rows;   ///< rows of the remainder × points: value, gradient, Hessian
};

/// Points, gradient and Hessian of a batch. Each entry is a group.
struct Assembly {
  /// x -> q, q', t at the quadrature points.
  void (*expand)(const ElementShape&, const ElementBatch&);
  /// L_d, its gradient (m) and, where slope_h is not null, ∂L_d/∂h.
  void (*gradient)(const ElementShape&, const ElementBatch&, double* action, double* gradient,
                   double* slope_h);
  /// Adds the lower triangle of the Hessian: contribution by contribution to the places `slots` (tables.hpp).
  void (*hessian)(const ElementShape&, const ElementBatch&, const int* slots, double* matrix);
  /// ∂²L_d/∂x∂h (m) and ∂²L_d/∂h².
  void (*border)(const ElementShape&, const ElementBatch&, double* row, double* corner);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(Assembly assembly_kernels())

/// Those of the level in use.
const Assembly& assembly();

}  // namespace extremal
