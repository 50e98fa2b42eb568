#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "system/expression.hpp"

/// \file Expressions in a form that stays cheap when differentiated: numerical factors and signs are
/// carried beside the node, products are kept as powers of their bases, so that equal products are one
/// node however they arose and all powers of a base come from one reciprocal or square root.

namespace extremal {

/// factor · node. Zero has factor 0; a number c is c · 1.
struct Scaled {
  double factor = 0;
  NodeId node = 0;
  bool zero() const { return factor == 0; }
};

inline Scaled operator-(Scaled a) { return {-a.factor, a.node}; }

/// Builds nodes of one graph.
class Algebra {
 public:
  /// `uniform[k]`: input k is the same at all points. Uniform factors stand first in a product, so that
  /// their part of it is formed once.
  explicit Algebra(Graph& graph, std::vector<bool> uniform = {});

  const Graph& graph() const { return graph_; }

  Scaled constant(double value) const { return {value, one_}; }
  Scaled input(std::uint32_t index) { return {1, graph_.input(index)}; }
  /// factor · node, with the node's own sign or number taken into the factor.
  Scaled scaled(double factor, NodeId node) const;
  Scaled add(Scaled a, Scaled b);
  Scaled subtract(Scaled a, Scaled b) { return add(a, -b); }
  Scaled multiply(Scaled a, Scaled b);
  Scaled reciprocal(Scaled a);
  Scaled unary(Op op, Scaled a);
  Scaled binary(Op op, Scaled a, Scaled b);

  /// The product as one node. Its factor, but for the sign, is put on the first factor.
  NodeId node(Scaled a);

  /// The expression f of `from`, simplified, with input k replaced by replacement[k], or kept where
  /// `replacement` is empty.
  Scaled import(const Graph& from, NodeId f, std::span<const Scaled> replacement = {});

 private:
  struct Power {
    NodeId base;
    int halves;  ///< twice the exponent
  };
  struct Product {
    double factor = 1;
    std::vector<Power> powers;
  };

  Product product(NodeId node) const;
  void include(Product& product, Power power);
  bool before(NodeId a, int halves_a, NodeId b, int halves_b);
  bool uniform(NodeId node);
  Scaled power(Scaled a, int halves);
  NodeId power_node(Power power);
  NodeId build(double factor, const std::vector<Power>& powers);
  void remember(NodeId node, double factor, const std::vector<Power>& powers);

  Graph& graph_;
  NodeId one_;
  std::vector<bool> uniform_inputs_;
  std::vector<bool> uniform_;                         ///< by node, as far as known
  std::unordered_map<NodeId, Product> products_;      ///< of the nodes that are products
  std::unordered_set<NodeId> rooted_;                 ///< nodes whose square root is in the graph
  std::unordered_map<std::uint64_t, NodeId> powers_;  ///< by base and halves
};

}  // namespace extremal
