#pragma once

#include "machine/simd.hpp"

/// \file The innermost loops of marching: one element, its quadrature points in the lanes. Plain data only,
/// because the same header serves the kernels of every instruction set.
///
/// As in action/element.hpp the element is
///   q(τ) = q_a + τ Δ + Σ_J d_J φ_J(τ),
/// but q_a is known. The unknowns of coordinate a are x[a*s + K]: K < s − 1 the deviations d, K = s − 1 the
/// displacement Δ. The equations of coordinate a are numbered likewise: I < s − 1 stationarity in d_I, and
/// I = s − 1 the momentum at the start, p_a + ∂L_d/∂q_a = 0.

namespace extremal {

/// Derivatives of L that couple two coordinates.
struct CoupledPair {
  int a, b;               ///< of the equation, of the unknown
  int qq, qv, vq, vv;     ///< rows of the remainder's Hessian by (a, b), or -1; qv: ∂²/∂q_a∂q'_b
  double mass, qv0, vq0;  ///< constant parts
  bool velocities;        ///< anything but qq and mass
};

struct MassView {
  int row, column;
  double value;
};

/// Scheme and Lagrangian as the kernels see them. `width` and `functions` are rounded up to whole lanes; what
/// is added has weight zero.
struct StepShape {
  int n, s, points, width, functions;
  const double* node;         ///< width: c_i
  const double* weight;       ///< width: b_i
  const double* value;        ///< (s − 1) × width: φ_J(c_i)
  const double* slope;        ///< (s − 1) × width: φ_J'(c_i)
  const double* sum_value;    ///< points × functions: φ_I(c_i), I = s − 1 being τ
  const double* sum_slope;    ///< points × functions: φ_I'(c_i)
  const double* test_value;   ///< points × functions: b_i φ_I(c_i), I = s − 1 being 1 − τ
  const double* test_slope;   ///< points × functions: b_i φ_I'(c_i)
  const double* trial_value;  ///< points × s: φ_K(c_i), K = s − 1 being τ
  const double* trial_slope;  ///< points × s: φ_K'(c_i)
  const double* stiffness;    ///< s × functions: Σ b_i φ_K' φ_I', by trial function

  int mass_count, gyroscopic_count, gradient_count, pair_count;
  const MassView *mass, *gyroscopic;  ///< entries of M and C(row of q', column of q)
  const double* linear;               ///< n, or null
  const int* gradient;                ///< z of each gradient row
  const CoupledPair* pairs;
};

/// Where the values of an element stand; rows of `width`.
struct StepPoints {
  double *q, *v, *t;        ///< n, n and 1 rows
  const double* remainder;  ///< value, gradient, Hessian
  double *dq, *dv;          ///< n rows each: b_i ∂L/∂q, b_i ∂L/∂q'
};

struct StepKernels {
  /// q, q' and, where there is a place for it, t at the quadrature points.
  void (*expand)(const StepShape&, const StepPoints&, const double* start, double time, double h,
                 const double* x);
  /// ∂L/∂q and ∂L/∂q' there; for each coordinate the derivatives `out` (functions) of L_d by d_I and, at
  /// I = s − 1, by q_b, and the change of momentum h Σ b_i ∂L/∂q. Returns L_d. The same rounded numbers
  /// φ_I(c_i) make q and these sums: so roundoff of the tables leaves them derivatives of a discrete action,
  /// and the energy does not drift with them.
  double (*gather)(const StepShape&, const StepPoints&, double h, double* out, double* force);
  /// The transposed matrix of the equations, n s rows of `stride`: [(b*s + K)*stride + a*s + I].
  void (*matrix)(const StepShape&, const StepPoints&, double h, double* matrix, int stride);
  /// Replaces a matrix of `size` rows by its inverse; false where it is singular or not finite. `work`:
  /// 2 size doubles.
  bool (*invert)(int size, int stride, double* matrix, double* work);
  /// y = − (transposed matrix) r; both have `stride` entries.
  void (*multiply)(int size, int stride, const double* matrix, const double* r, double* y);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(StepKernels step_kernels())

/// Those of the level in use.
const StepKernels& step_kernels();

}  // namespace extremal
