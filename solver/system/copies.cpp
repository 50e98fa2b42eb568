#include "system/copies.hpp"

#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

namespace extremal {

NodeId copied(const Graph& from, NodeId body, std::span<const NodeId> inputs, Graph& to) {
  std::unordered_map<NodeId, NodeId> image;
  for (const NodeId id : nodes_of(from, body)) {
    const Node n = from[id];
    image[id] = n.op == Op::constant ? to.constant(n.value)
                : n.op == Op::input  ? inputs[n.index]
                : arity(n.op) == 1   ? to.unary(n.op, image[n.a])
                                     : to.binary(n.op, image[n.a], image[n.b]);
  }
  return image[body];
}

namespace {

/// Global inputs of Λ: q₁, q₂, k, their velocities, t, numbers.
class Doubling {
 public:
  Doubling(const LagrangianGraph& lagrangian, const LagrangianGraph& power, int shared)
      : n_(lagrangian.coordinates), own_(n_ - shared), all_(n_ + own_), l_(lagrangian), power_(power) {
    result_.coordinates = static_cast<int>(all_);
    result_.parameters = lagrangian.parameters;
    result_.replaceable = lagrangian.replaceable;
    result_.uniforms = lagrangian.uniforms;
    result_.uniforms.insert(result_.uniforms.end(), power.uniforms.begin() + power.parameters,
                            power.uniforms.end());
  }

  LagrangianGraph run() {
    for (const Term& term : l_.terms) {
      add_copy(term, 0);
      add_copy(term, 1);
    }
    for (const Term& term : power_.terms) add_power(term);
    return std::move(result_);
  }

 private:
  void add_copy(const Term& term, std::uint32_t copy) {
    std::vector<NodeId> inputs;
    for (int m = 0; m < term.arity; ++m) inputs.push_back(result_.graph.input(m));
    Term added{copied(l_.graph, term.body, inputs, result_.graph), term.arity, term.table};
    if (copy == 1) added.body = result_.graph.unary(Op::neg, added.body);
    for (std::uint32_t& global : added.table)
      global = global < n_       ? coordinate(global, copy)
               : global < 2 * n_ ? all_ + coordinate(global - n_, copy)
                                 : 2 * (all_ - n_) + global;
    result_.terms.push_back(std::move(added));
  }

  /// Of F·λ: q, λ, q', λ' (n each), t, numbers. What has two copies becomes two inputs.
  void add_power(const Term& term) {
    Graph& graph = result_.graph;
    std::vector<NodeId> inputs;
    std::vector<bool> twice;
    std::uint32_t arity = 0;
    for (int m = 0; m < term.arity; ++m) {
      const std::uint32_t kind = term.table[m] / n_;
      twice.push_back(kind < 4 && term.table[m] % n_ < own_);
      const NodeId first = graph.input(arity++);
      if (!twice.back()) {
        inputs.push_back(first);
        continue;
      }
      const NodeId second = graph.input(arity++);
      inputs.push_back(kind % 2 == 1 ? graph.sub(first, second)
                                     : graph.mul(graph.constant(0.5), graph.add(first, second)));
    }
    Term added{copied(power_.graph, term.body, inputs, graph), static_cast<int>(arity), {}};
    for (std::size_t e = 0; e < term.table.size(); ++e) {
      const std::uint32_t global = term.table[e], kind = global / n_;
      if (twice[e % term.arity]) {
        const std::uint32_t first = (kind < 2 ? 0 : all_) + global % n_;
        added.table.insert(added.table.end(), {first, first + own_});
      } else if (kind < 4) {
        added.table.push_back((kind < 2 ? 0 : all_) + coordinate(global % n_, 0));
      } else {
        added.table.push_back(number(global));
      }
    }
    result_.terms.push_back(std::move(added));
  }

  /// Of Λ, coordinate a of one copy.
  std::uint32_t coordinate(std::uint32_t a, std::uint32_t copy) const {
    return a < own_ ? copy * own_ + a : own_ + a;
  }

  /// t or a number.
  std::uint32_t number(std::uint32_t global) const {
    const std::uint32_t active = 4 * n_ + 1 + power_.parameters;
    const auto before = static_cast<std::uint32_t>(l_.uniforms.size() - l_.parameters);
    return 2 * all_ - 4 * n_ + (global < active ? global : global + before);
  }

  const std::uint32_t n_, own_, all_;  ///< coordinates of L, of one copy alone, of Λ
  const LagrangianGraph &l_, &power_;
  LagrangianGraph result_;
};

}  // namespace

LagrangianGraph two_copies(const LagrangianGraph& lagrangian, const LagrangianGraph& power, int shared) {
  if (power.coordinates != 2 * lagrangian.coordinates || power.parameters != lagrangian.parameters)
    throw std::invalid_argument("F·λ and L belong to different systems");
  return Doubling(lagrangian, power, shared).run();
}

}  // namespace extremal
