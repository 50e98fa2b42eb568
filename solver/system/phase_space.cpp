#include "system/phase_space.hpp"

#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "system/constraints.hpp"

namespace extremal {

namespace {

/// L on a graph of its own.
class PhaseForm {
 public:
  PhaseForm(const LagrangianGraph& hamiltonian, const PhaseWeights& weights)
      : n_(hamiltonian.coordinates), weights_(weights) {
    result_.coordinates = 2 * n_;
    result_.parameters = hamiltonian.parameters;
    result_.uniforms.assign(hamiltonian.uniforms.begin(), hamiltonian.uniforms.begin() + result_.parameters);
    result_.first_order = true;
    const NodeId h = flattened(hamiltonian, graph());
    if (has_kinks(graph(), h))
      throw std::invalid_argument(
          "H_pp is singular, and abs, min, max or step stands in the Hamiltonian, which must then be smooth; "
          "write it with a smooth function, such as sqrt(u^2 + e^2) for abs(u)");
    h_ = substitute(graph(), h, renumbered());
    slopes_ = gradient(graph(), h_, variables());
  }

  LagrangianGraph run() {
    Symbol sum = -symbol(h_);
    for (int a = 0; a < n_; ++a) {
      const Symbol q = coordinate(a), p = momentum(a), q_rate = input(2 * n_ + a), p_rate = input(3 * n_ + a);
      sum += weights_.symmetric ? 0.5 * (p * q_rate - q * p_rate) : p * q_rate;
      if (weights_.velocity == 0 && weights_.force == 0) continue;
      const Symbol e = q_rate - symbol(slopes_[n_ + a]), f = p_rate + symbol(slopes_[a]);
      sum += 0.5 * weights_.velocity * (e * e) + 0.5 * weights_.force * (f * f);
    }
    std::vector<std::uint32_t> table(4 * n_ + 1 + result_.uniforms.size());
    std::iota(table.begin(), table.end(), 0u);
    const int arity = static_cast<int>(table.size());
    result_.terms.push_back({sum.node(graph()), arity, std::move(table)});
    return std::move(result_);
  }

 private:
  Graph& graph() { return result_.graph; }
  Symbol input(int index) { return symbol(graph().input(static_cast<std::uint32_t>(index))); }
  Symbol symbol(NodeId id) { return {&graph(), id}; }

  /// Inputs q, p, t and parameters of H as those of L.
  std::vector<NodeId> renumbered() {
    std::vector<NodeId> nodes;
    for (int a = 0; a < n_; ++a) nodes.push_back(coordinate(a).node(graph()));
    for (int a = 0; a < n_; ++a) nodes.push_back(momentum(a).node(graph()));
    nodes.push_back(moved(input(4 * n_), -weights_.shift, 1).node(graph()));
    for (int k = 1; k <= result_.parameters; ++k)
      nodes.push_back(graph().input(static_cast<std::uint32_t>(4 * n_ + k)));
    return nodes;
  }

  static Symbol moved(const Symbol& x, double by, const Symbol& rate) { return by == 0 ? x : x + by * rate; }
  Symbol coordinate(int a) { return moved(input(a), -weights_.shift, input(2 * n_ + a)); }
  Symbol momentum(int a) { return moved(input(n_ + a), weights_.shift, input(3 * n_ + a)); }

  std::vector<std::uint32_t> variables() const {
    std::vector<std::uint32_t> by(2 * n_);
    std::iota(by.begin(), by.end(), 0u);
    return by;
  }

  const int n_;
  const PhaseWeights& weights_;
  LagrangianGraph result_;
  NodeId h_ = 0;
  std::vector<NodeId> slopes_;  ///< ∂H/∂(q, p)
};

}  // namespace

std::shared_ptr<const Lagrangian> phase_lagrangian(const LagrangianGraph& hamiltonian,
                                                   const PhaseWeights& weights) {
  return make_lagrangian(PhaseForm(hamiltonian, weights).run());
}

}  // namespace extremal
