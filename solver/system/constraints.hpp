#pragma once

#include <vector>

#include "system/tape.hpp"

/// \file Holonomic constraints g(q, t) = 0 in a Lagrangian of the same coordinates.
///
/// Near the manifold of the constraints a point is q = P(x, t), where P moves x onto the manifold:
///   P₁ = x − W Gᵀ A⁻¹ g(x),  P₂ = P₁ − W Gᵀ A⁻¹ g(P₁),  P = P₂ − W Gᵀ A⁻¹ g(P₂),  G = ∂g/∂q at x,  A = G W
///   Gᵀ,
/// W a constant metric. g(P) is of fourth order in g(x). Let c_k = g_k / √A_kk. The extremals of
///   L̃ = L(P, dP/dt, t) + ½ Σ_k (c_k'² + ω² c_k²)
/// that begin and end with c = 0 are those of L under the constraints. For P is the identity on the manifold,
/// and its derivative projects onto the tangent space: variations of x along W Gᵀ do not change L(P) to
/// second order, and the others are the virtual displacements. So the second variation is that under the
/// constraints, beside one of c alone, which is positive: it adds nothing to index, nullity and conjugate
/// times, and to the multipliers of closed paths pairs exp(±ωT). The mass matrix is regular where that of L
/// is on tangent vectors. In a basis without W the momenta ∂L̃/∂x' are the projections (∂P/∂x)ᵀ ∂L/∂q'.

namespace extremal {

/// L and left sides of constraints over one graph. Inputs are numbered as in Term; uniforms are the active
/// parameters alone.
struct ConstrainedGraph {
  int coordinates = 0;
  Graph graph;
  NodeId lagrangian = 0;
  std::vector<NodeId> constraints;
  std::vector<NodeId> forces{};  ///< F, one for each coordinate; empty: there are none
  std::vector<double> parameters;
};

/// All rows of all terms, with their numbers put in, as one expression of q, q', t and active parameters.
NodeId flattened(const LagrangianGraph& lagrangian, Graph& target);

/// Whether an expression has kinks: abs, min, max, step.
bool has_kinks(const Graph& graph, NodeId f);

/// How points are moved onto the manifold, and the rate ω of what is beside it.
struct NormalMotion {
  std::vector<Triplet> metric;  ///< W, symmetric and positive definite, both triangles
  double rate = 0;
  int constants = 0;  ///< so many of the last coordinates have no velocity, and are not moved
};

/// L̃.
LagrangianGraph projected(ConstrainedGraph system, const NormalMotion& normal);

/// The power F(P, dP/dt, t)·(∂P/∂x λ) of the forces in the coordinates (x, λ), as two_copies() takes it.
/// Where a displacement λ is normal to the manifold it vanishes: forces do not move c.
LagrangianGraph projected_power(ConstrainedGraph system, const NormalMotion& normal);

/// ∂/∂λ of F·λ, which is given in the coordinates (q, λ), as expressions of q, q', t on another graph.
std::vector<NodeId> forces_of_power(const LagrangianGraph& power, Graph& target);

/// L with t as one more coordinate, the last one.
LagrangianGraph with_time_as_coordinate(const ConstrainedGraph& system);

/// Σ_k μ_k g_k in the coordinates (q, t, μ): its derivatives are g, ∂g/∂q, ∂g/∂t, and the second derivatives
/// of each g_k.
LagrangianGraph multiplier_form(const ConstrainedGraph& system);

}  // namespace extremal
