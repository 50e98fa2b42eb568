#pragma once

#include <span>

#include "system/tape.hpp"

/// \file Forces in an action: two copies of a system.
///
/// A force F(q, q', t) that no Lagrangian has enters the equations of motion by the principle of Lagrange and
/// d'Alembert, δS + ∫ F·δq dt = 0. Two copies q₁, q₂ of the coordinates have a Lagrangian of their own,
///   Λ = L(q₁, q₁', t) − L(q₂, q₂', t) + F(u, u', t)·λ,   u = (q₁ + q₂)/2,  λ = q₁ − q₂,
/// (C. R. Galley, Phys. Rev. Lett. 110 (2013) 174301). Where q₁ = q₂ = q the derivative of its action by λ is
/// δS + ∫ F·δq dt, and that by u vanishes. So the stationary points with q₁ = q₂ are the motions with forces;
/// and those of the discrete action satisfy the discrete principle, with the quadrature of the scheme for S
/// and for the work of F. Exchanging the copies changes the sign of Λ: in (u, λ) its Hessian at λ = 0 is
///   (0 Aᵀ; A 0),
/// A the linearised equations of motion, which are not symmetric, and steps of Newton's method from q₁ = q₂
/// keep q₁ = q₂. In (q₁, q₂) the mass is diag(M, −M): the elimination of symmetric systems does without
/// pivoting as it does for L.

namespace extremal {

/// Λ in 2n coordinates (q₁, q₂), of L in n and of `power` = F·λ in 2n, (q, λ). In each term of `power` an
/// input is of one kind in all rows. The last `shared` coordinates k are constants of both copies, which have
/// no velocity and no force: Λ has the coordinates (q₁, q₂, k).
LagrangianGraph two_copies(const LagrangianGraph& lagrangian, const LagrangianGraph& power, int shared = 0);

/// An expression of another graph, with expressions in place of its inputs.
NodeId copied(const Graph& from, NodeId body, std::span<const NodeId> inputs, Graph& to);

}  // namespace extremal
