#include "system/hamiltonian.hpp"

#include <algorithm>

#include "system/legendre_lagrangian.hpp"

namespace extremal {

namespace {

/// Whether abs, min, max or step of something that depends on momenta stands in H.
bool kinked_in_momenta(const LagrangianGraph& h) {
  const auto n = static_cast<std::uint32_t>(h.coordinates);
  for (const Term& term : h.terms) {
    const std::vector<NodeId> nodes = nodes_of(h.graph, term.body);
    if (std::ranges::none_of(nodes, [&](NodeId id) { return has_kink(h.graph[id].op); })) continue;
    std::vector<bool> momentum(term.arity), depends(term.body + 1);
    for (std::size_t e = 0; e < term.table.size(); ++e)
      if (term.table[e] >= n && term.table[e] < 2 * n) momentum[e % term.arity] = true;
    for (const NodeId id : nodes) {
      const Node& node = h.graph[id];
      depends[id] = node.op == Op::input
                        ? momentum[node.index]
                        : (arity(node.op) > 0 && depends[node.a]) || (arity(node.op) > 1 && depends[node.b]);
      if (has_kink(node.op) && depends[id]) return true;
    }
  }
  return false;
}

LagrangianGraph negative(LagrangianGraph h) {
  for (Term& term : h.terms) term.body = h.graph.unary(Op::neg, term.body);
  return h;
}

/// The kinks of L where those of H do not depend on momenta: then ∂L/∂q jumps as −∂H/∂q does at the same
/// point.
std::shared_ptr<const Kinks> kinks_of_lagrangian(const LagrangianGraph& hamiltonian) {
  auto kinks = find_kinks(negative(hamiltonian));
  if (!kinks) return kinks;
  for (const KinkSurface& surface : kinks->surfaces()) {
    const Structure& s = surface.odd->structure();
    if (!s.mass.empty() || !s.gyroscopic.empty() || !s.linear.empty() || !s.velocity_free)
      throw std::invalid_argument(
          "abs, min, max or step multiplies momenta here, and the Hamiltonian is not quadratic in them; "
          "write it with a smooth function");
  }
  return kinks;
}

}  // namespace

std::shared_ptr<const Lagrangian> make_lagrangian_of(const LagrangianGraph& hamiltonian) {
  if (kinked_in_momenta(hamiltonian))
    throw std::invalid_argument(
        "abs, min, max or step of momenta stands in the Hamiltonian, which must be smooth in them; write it "
        "with a smooth function, such as sqrt(p^2 + e^2) for abs(p)");
  if (std::optional<LagrangianGraph> lagrangian = legendre_transform(hamiltonian))
    return make_lagrangian(*std::move(lagrangian));
  return std::make_shared<LegendreLagrangian>(hamiltonian, kinks_of_lagrangian(hamiltonian));
}

const Lagrangian* hamiltonian_of(const Lagrangian& lagrangian) {
  const auto* l = dynamic_cast<const LegendreLagrangian*>(&lagrangian);
  return l ? &l->hamiltonian() : nullptr;
}

}  // namespace extremal
