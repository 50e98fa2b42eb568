#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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
/// operands are finite by more than roundoff, nor removes a division (a/a stays, 0/a becomes 0).
/// Constants merge across an operation, as in 2*(3*a), only where that is exact, so that derivatives hold
/// in extended precision too. An operation on constants whose value is not finite stays as it is written.
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
  /// The node equal to this one, or absent.
  NodeId find(const Node& node) const;
  std::size_t slot_of(const Node& node) const;
  void grow();
  NodeId sum(NodeId a, NodeId b);
  NodeId difference(NodeId a, NodeId b);
  NodeId product(NodeId a, NodeId b);
  NodeId quotient(NodeId a, NodeId b);
  NodeId power(NodeId a, NodeId b);
  NodeId integer_power(NodeId a, int exponent);
  NodeId negative(NodeId a);
  NodeId scaled(double factor, NodeId a);

  std::vector<Node> nodes_;
  std::vector<NodeId> slots_;  ///< open addressing, a power of two long; `absent` where free
};

/// The nodes that f is made of, f included, ascending: arguments precede their users.
std::vector<NodeId> nodes_of(const Graph& graph, NodeId f);

/// d f / d input(k) for each k of `inputs`, by reverse accumulation on the graph.
std::vector<NodeId> gradient(Graph& graph, NodeId f, std::span<const std::uint32_t> inputs);

/// f with each input k replaced by replacement[k]. Throws std::invalid_argument where there is none.
NodeId substitute(Graph& graph, NodeId f, std::span<const NodeId> replacement);

/// The inputs that f depends on, ascending.
std::vector<std::uint32_t> inputs_of(const Graph& graph, NodeId f);

/// The value of f in any scalar type: double, long double, complex (min, max, abs and step compare real
/// parts), multiprecision. Defined in system/expression_evaluate.hpp; compiled for double.
template <class Scalar>
Scalar evaluate(const Graph& graph, NodeId f, std::span<const Scalar> inputs);

}  // namespace extremal
