#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

/// \file The expression graph: a directed acyclic graph of hash-consed nodes, so that equal
/// subexpressions are one node. Formulas and traced C++ functors both end here.

namespace extremal {

enum class Op : std::uint8_t {
  constant,  ///< node.value
  input,     ///< node.index
  add, sub, mul, div, pow, atan2, min, max,                          // two arguments
  step,      ///< 1 where a >= b, else 0 (the derivative of min, max and abs)
  neg, abs, sqrt, exp, log,                                          // one argument
  sin, cos, tan, asin, acos, atan, sinh, cosh, tanh,
};

/// 0, 1 or 2.
int arity(Op op);

using NodeId = std::uint32_t;

struct Node {
  Op op;
  NodeId a = 0, b = 0;      ///< arguments
  double value = 0;         ///< of a constant
  std::uint32_t index = 0;  ///< of an input
};

/// Nodes in an order in which arguments precede their users. Building folds constants, drops neutral
/// elements and orders the arguments of commutative operations; it never changes a value where the
/// operands are finite by more than roundoff.
class Graph {
 public:
  NodeId constant(double value);
  NodeId input(std::uint32_t index);
  NodeId unary(Op op, NodeId a);
  NodeId binary(Op op, NodeId a, NodeId b);

  NodeId add(NodeId a, NodeId b) { return binary(Op::add, a, b); }
  NodeId sub(NodeId a, NodeId b) { return binary(Op::sub, a, b); }
  NodeId mul(NodeId a, NodeId b) { return binary(Op::mul, a, b); }
  NodeId div(NodeId a, NodeId b) { return binary(Op::div, a, b); }
  /// Integer and half-integer powers become products and square roots.
  NodeId pow(NodeId a, NodeId b) { return binary(Op::pow, a, b); }

  const Node& operator[](NodeId id) const { return nodes_[id]; }
  std::size_t size() const { return nodes_.size(); }
  bool is_constant(NodeId id) const { return nodes_[id].op == Op::constant; }
  bool is_constant(NodeId id, double value) const {
    return nodes_[id].op == Op::constant && nodes_[id].value == value;
  }

 private:
  NodeId intern(const Node& node);
  std::vector<Node> nodes_;
  std::unordered_multimap<std::uint64_t, NodeId> index_;
};

/// d f / d input(k) for each k of `inputs`, by reverse accumulation on the graph.
std::vector<NodeId> gradient(Graph& graph, NodeId f, std::span<const std::uint32_t> inputs);

/// f with each input k replaced by replacement[k].
NodeId substitute(Graph& graph, NodeId f, std::span<const NodeId> replacement);

/// The inputs that f depends on, ascending.
std::vector<std::uint32_t> inputs_of(const Graph& graph, NodeId f);

/// The value of f in any scalar type: double, long double, complex, multiprecision.
template <class Scalar>
Scalar evaluate(const Graph& graph, NodeId f, std::span<const Scalar> inputs);

}  // namespace extremal
