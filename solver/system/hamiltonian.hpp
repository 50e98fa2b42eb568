#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "system/tape.hpp"

/// \file Systems given by a Hamiltonian H(q, p, t). The stationary points of ∫ (p·q' − H) dt in (q, p), with
/// p one value at each quadrature point, have v = q' = ∂H/∂p there. Where ∂²H/∂p∂p is regular that determines
/// p by q, v, t, and with
///   L(q, v, t) = p·v − H(q, p, t)
/// the phase-space action is the action of L in every scheme. The derivatives are
///   L_q = −H_q,  L_v = p,  L_vv = H_pp⁻¹,  L_vq = −H_pp⁻¹ H_pq,  L_qq = −H_qq + H_qp H_pp⁻¹ H_pq.

namespace extremal {

/// ∂²H/∂p∂p is singular at every point.
struct SingularHamiltonian : std::invalid_argument {
  std::vector<int> momenta;  ///< whose rows of it depend on each other, by coordinate
  SingularHamiltonian(const std::string& message, std::vector<int> momenta)
      : std::invalid_argument(message), momenta(std::move(momenta)) {}
};

/// Momenta that H_pp couples are solved for together; more than these at a time are refused.
constexpr int most_coupled_momenta = 400;

/// L as an expression graph, where H is made of quadratic forms of the momenta and of square roots of such,
/// and H_pp couples few of them at a time. The velocity inputs of `hamiltonian` stand for momenta. Sums stay
/// sums. Nothing where H is not such. Throws SingularHamiltonian.
std::optional<LagrangianGraph> legendre_transform(const LagrangianGraph& hamiltonian);

/// L of a Hamiltonian: a TapeLagrangian where it has an expression, else a LegendreLagrangian. Throws
/// SingularHamiltonian, and std::invalid_argument where H is not smooth in a way that depends on momenta.
std::shared_ptr<const Lagrangian> make_lagrangian_of(const LagrangianGraph& hamiltonian);

/// H, with momenta for velocities, where L is a LegendreLagrangian; else null.
const Lagrangian* hamiltonian_of(const Lagrangian& lagrangian);

/// L of H = functor(q, p, t), traced once:
///   auto kepler = trace_hamiltonian(2, [](auto q, auto p, auto t) {
///     return (p[0]*p[0] + p[1]*p[1])/2 - 1/sqrt(q[0]*q[0] + q[1]*q[1]); });
template <class Functor>
std::shared_ptr<const Lagrangian> trace_hamiltonian(int coordinates, Functor&& functor) {
  return make_lagrangian_of(trace_graph(coordinates, functor));
}

}  // namespace extremal
