#pragma once

#include <vector>

#include "system/chart.hpp"
#include "system/constraints.hpp"
#include "system/kernel.hpp"

/// \file L under holonomic constraints g(q, t) = 0 in n − m coordinates u of their manifold.
///
/// q = B z(u, w), and near a point where ∂g/∂w =: A is regular g = 0 makes w a function of u and t, w' one of
/// u, u', t: A w' = −(g_u u' + g_t). Let L̂(u, u', t) be L there. With y = (u, w), multipliers for both,
///   ν = −A⁻ᵀ L_w',  μ = −A⁻ᵀ (L_w + (g')_wᵀ ν),   F = L + μ·g + ν·g',  g' = g_y y' + g_t,
/// the derivatives of L̂ are those of F, which has none by w and w':
///   L̂_u = F_u,  L̂_u' = F_u',  ∂²L̂ = Zᵀ (∂²F by (y, y')) Z  at fixed μ, ν,   Z = ∂(y, y')/∂(u, u').
///
/// Forces have the covector K(y, y', t) in y, and Q = (∂y/∂u)ᵀ K in u. With μ = −A⁻ᵀ (L_w + K_w + (g')_wᵀ ν),
/// which balances them too,
///   L̂_u + Q = F_u + K_u,   ∂(L̂_u + Q, L̂_u') = Zᵀ (∂²F + (∂K; 0)) Z  at fixed μ, ν.

namespace extremal {

/// A kernel whose inputs are y (coordinates), u' (velocities) and t, and what it computes.
struct MinimalExpressions {
  struct Second {
    int row, column;
    Scaled value;
  };
  Kernel kernel;
  Scaled value;
  std::vector<Partial> gradient;  ///< by (u, u')
  std::vector<Second> hessian;    ///< lower triangle, sorted
  std::vector<Scaled> start;   ///< w where the search begins: the solution itself where g is quadratic in it
  std::vector<Scaled> steps;   ///< Newton's step A⁻¹ g, to be taken from w; y and t alone
  std::vector<Scaled> pivots;  ///< of A, with their signs in the chart: positive
  std::vector<Scaled> rates;   ///< w'
  std::vector<Scaled> slopes;  ///< ∂w/∂u, m × (n − m)
  bool autonomous = true;
  /// With forces, else empty:
  std::vector<Scaled> motion;  ///< L̂_u + Q, L̂_u'
  std::vector<Second>
      copies_hessian;  ///< by (q₁, q₂, q₁', q₂') of two copies of u where these agree; likewise
  bool autonomous_forces = true;
};

MinimalExpressions minimal_expressions(const ConstrainedGraph& system, const Chart& chart);

}  // namespace extremal
