#pragma once

#include <memory>

#include "system/tape.hpp"

/// \file Systems with a Hamiltonian H(q, p, t) in phase space, for any ∂²H/∂p∂p.
///
/// The stationary points of ∫ (p·q' − H) dt in z = (q, p) are the solutions of Hamilton's equations
///   e = q' − ∂H/∂p = 0,  f = p' + ∂H/∂q = 0.
/// That Lagrangian is linear in the velocities: continuous polynomials for q and p have no regular equations
/// with it. Let
///   L = p·q' − H + ½ Σ_a (w e_a² + v f_a²),   w, v > 0 constant.
/// The squares and their first derivatives vanish where e = f = 0. So these solutions are stationary for L as
/// well, with the same action, the momenta ∂L/∂q' = p, ∂L/∂p' = 0 and the energy H; and L_z'z' = diag(w, v)
/// is positive. Let q and p be of degree s in each element, and the action be summed by Gauss's rule with s
/// points. It is exact for p·δq', so that by parts
///   δS_h = Σ h b_i (δp·e − δq·f + w e·δe + v f·δf) + [p·δq].
/// Where e = f = 0 at all points this is the boundary term alone: the collocation of Hamilton's equations at
/// Gauss's points is stationary, for any w and v. It is the symplectic Runge-Kutta method of Gauss, and the
/// scheme that has values of p at these points (README, Hamiltonians).
///
/// Conversely let L be stationary. Then y = (w e, v f) solves a linear homogeneous equation along the path,
/// the variational equation of H + ½ (p²/v + q²/w) but for the order of its entries, with as many homogeneous
/// end conditions. So y vanishes but in exceptional cases, which are found by evaluating it. The second
/// variation is A + A W A with A that of ∫ (p·q' − H) dt and W = diag(w, v) turned by a right angle: its null
/// directions are those of A, and others where A has an eigenvalue −1/√(wv) in units with w = v. With √(wv)
/// of the size of the duration that is beside the eigenvalues near 0, and the condition of the equations is
/// that of A or, for high frequencies, that of a system of second order.

namespace extremal {

/// How H becomes L.
struct PhaseWeights {
  double velocity = 1, force = 1;  ///< w and v; both 0: the Lagrangian linear in velocities
  /// ½ (p·q' − q·p') in place of p·q': symmetries that mix q and p leave it unchanged. The momenta are then
  /// (p, −q)/2.
  bool symmetric = false;
  /// q − shift·q', p + shift·p' and t − shift stand in place of q, p and t. By the midpoint rule on elements
  /// of the length h, ±h/2 makes of it the rule with q at one end and p at the other (Cresson-Safi (16),
  /// (17)): with h/2 the left rectangle, −h/2 the right one. All that is said above holds for these as well.
  double shift = 0;
};

/// L in the 2n coordinates (q, p). The velocity inputs of `hamiltonian` stand for momenta. Throws
/// std::invalid_argument for an H with kinks.
std::shared_ptr<const Lagrangian> phase_lagrangian(const LagrangianGraph& hamiltonian,
                                                   const PhaseWeights& weights);

}  // namespace extremal
