#include "system/expression.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "system/expression_evaluate.hpp"

namespace extremal {

namespace {

constexpr NodeId absent = std::numeric_limits<NodeId>::max();
constexpr int largest_product = 16;  ///< exponents beyond are left to pow

bool same(const Node& x, const Node& y) {
  return x.op == y.op && x.a == y.a && x.b == y.b && x.index == y.index &&
         std::bit_cast<std::uint64_t>(x.value) == std::bit_cast<std::uint64_t>(y.value);
}

std::uint64_t hash(const Node& node) {
  // The finalizer of MurmurHash3 over the fields; constants have no arguments, the others no value.
  std::uint64_t h = (std::uint64_t{node.a} << 32 | node.b) ^ std::bit_cast<std::uint64_t>(node.value);
  h += (std::uint64_t{node.index} << 8 | static_cast<std::uint64_t>(node.op)) * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 33) * 0xff51afd7ed558ccdu;
  h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53u;
  return h ^ h >> 33;
}

bool exact_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return std::isfinite(sum) && (a - (sum - part)) + (b - part) == 0;
}

/// A product or quotient that underflows has lost digits which its remainder does not show.
bool is_normal(double value) { return std::isnormal(value) && std::abs(value) > 1e-250; }

bool exact_product(double a, double b) { return is_normal(a * b) && std::fma(a, b, -(a * b)) == 0; }
bool exact_quotient(double a, double b) { return is_normal(a / b) && std::fma(a / b, b, -a) == 0; }

bool is_power_of_two(double value) {
  int exponent = 0;
  return is_normal(value) && is_normal(1 / value) && std::abs(std::frexp(value, &exponent)) == 0.5;
}

}  // namespace

int arity(Op op) {
  if (op == Op::constant || op == Op::input) return 0;
  return op <= Op::step ? 2 : 1;
}

std::size_t Graph::slot_of(const Node& node) const {
  std::size_t slot = hash(node) & (slots_.size() - 1);
  while (slots_[slot] != absent && !same(nodes_[slots_[slot]], node)) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

NodeId Graph::find(const Node& node) const { return slots_.empty() ? absent : slots_[slot_of(node)]; }

void Graph::grow() {
  slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), absent);
  for (NodeId id = 0; id < nodes_.size(); ++id) slots_[slot_of(nodes_[id])] = id;
}

NodeId Graph::intern(const Node& node) {
  if (2 * nodes_.size() >= slots_.size()) grow();
  NodeId& slot = slots_[slot_of(node)];
  if (slot == absent) {
    if (nodes_.size() >= absent) throw std::length_error("an expression of more than 2^32 nodes");
    slot = static_cast<NodeId>(nodes_.size());
    nodes_.push_back(node);
  }
  return slot;
}

NodeId Graph::constant(double value) {
  return intern({.op = Op::constant, .value = value == 0 ? 0.0 : value});
}

NodeId Graph::input(std::uint32_t index) { return intern({.op = Op::input, .index = index}); }

NodeId Graph::unary(Op op, NodeId a) {
  const Node x = nodes_[a];
  if (x.op == Op::constant) {
    const double value = scalar::apply(op, x.value, 0.0);
    if (std::isfinite(value)) return constant(value);
  }
  if (op == Op::neg) return negative(a);
  if (x.op == Op::neg) {  // parity, so that functions of a − b and of b − a are shared
    if (op == Op::abs || op == Op::cos || op == Op::cosh) return unary(op, x.a);
    if (op == Op::sin || op == Op::tan || op == Op::asin || op == Op::atan || op == Op::sinh ||
        op == Op::tanh)
      return negative(unary(op, x.a));
  }
  if (op == Op::abs && (x.op == Op::abs || x.op == Op::sqrt || x.op == Op::exp)) return a;
  return intern({.op = op, .a = a});
}

NodeId Graph::binary(Op op, NodeId a, NodeId b) {
  if (nodes_[a].op == Op::constant && nodes_[b].op == Op::constant) {
    const double value = scalar::apply(op, nodes_[a].value, nodes_[b].value);
    if (std::isfinite(value)) return constant(value);
    return intern({.op = op, .a = a, .b = b});
  }
  switch (op) {
    case Op::add:
      return sum(a, b);
    case Op::sub:
      return difference(a, b);
    case Op::mul:
      return product(a, b);
    case Op::div:
      return quotient(a, b);
    case Op::pow:
      return power(a, b);
    case Op::min:
    case Op::max:
      return a == b ? a : intern({.op = op, .a = std::min(a, b), .b = std::max(a, b)});
    default:
      return intern({.op = op, .a = a, .b = b});
  }
}

NodeId Graph::negative(NodeId a) {
  const Node x = nodes_[a];
  if (x.op == Op::constant) return constant(-x.value);
  if (x.op == Op::neg) return x.a;
  if (x.op == Op::mul && is_constant(x.a)) return scaled(-nodes_[x.a].value, x.b);
  return intern({.op = Op::neg, .a = a});
}

NodeId Graph::sum(NodeId a, NodeId b) {
  if (is_constant(b)) std::swap(a, b);  // a constant stands first
  const Node x = nodes_[a], y = nodes_[b];
  if (is_constant(a, 0)) return b;
  if (a == b) return scaled(2, a);
  if (y.op == Op::neg) return difference(a, y.a);
  if (x.op == Op::neg) return difference(b, x.a);
  if (x.op == Op::constant && y.op == Op::add && is_constant(y.a) && exact_sum(x.value, nodes_[y.a].value))
    return sum(constant(x.value + nodes_[y.a].value), y.b);
  if (x.op != Op::constant && a > b) std::swap(a, b);
  return intern({.op = Op::add, .a = a, .b = b});
}

NodeId Graph::difference(NodeId a, NodeId b) {
  const Node x = nodes_[a], y = nodes_[b];
  if (a == b) return constant(0);
  if (is_constant(a, 0)) return negative(b);
  if (y.op == Op::constant) return sum(constant(-y.value), a);
  if (y.op == Op::neg) return sum(a, y.a);
  if (x.op == Op::neg) return negative(sum(x.a, b));
  const NodeId reverse = find({.op = Op::sub, .a = b, .b = a});
  return reverse != absent ? intern({.op = Op::neg, .a = reverse}) : intern({.op = Op::sub, .a = a, .b = b});
}

NodeId Graph::scaled(double factor, NodeId a) {
  const Node x = nodes_[a];
  if (x.op == Op::constant && std::isfinite(factor * x.value)) return constant(factor * x.value);
  if (factor == 0) return constant(0);
  if (factor == 1) return a;
  if (x.op == Op::neg) return scaled(-factor, x.a);
  if (x.op == Op::mul && is_constant(x.a) && exact_product(factor, nodes_[x.a].value))
    return scaled(factor * nodes_[x.a].value, x.b);
  if (x.op == Op::div && is_constant(x.b) && exact_quotient(factor, nodes_[x.b].value))
    return scaled(factor / nodes_[x.b].value, x.a);
  if (factor == -1) return negative(a);
  return intern({.op = Op::mul, .a = constant(factor), .b = a});
}

NodeId Graph::product(NodeId a, NodeId b) {
  if (is_constant(b)) std::swap(a, b);
  const Node x = nodes_[a], y = nodes_[b];
  if (x.op == Op::constant) return scaled(x.value, b);
  if (x.op == Op::neg && y.op == Op::neg) return product(x.a, y.a);
  if (x.op == Op::neg) return negative(product(x.a, b));
  if (y.op == Op::neg) return negative(product(a, y.a));
  return intern({.op = Op::mul, .a = std::min(a, b), .b = std::max(a, b)});
}

NodeId Graph::quotient(NodeId a, NodeId b) {
  const Node x = nodes_[a], y = nodes_[b];
  if (is_constant(a, 0)) return a;
  if (x.op == Op::neg && y.op == Op::neg) return quotient(x.a, y.a);
  if (x.op == Op::neg) return negative(quotient(x.a, b));
  if (y.op == Op::neg) return negative(quotient(a, y.a));
  if (y.op == Op::constant) {
    if (y.value == 1) return a;
    if (is_power_of_two(y.value)) return scaled(1 / y.value, a);
    if (x.op == Op::mul && is_constant(x.a) && exact_quotient(nodes_[x.a].value, y.value))
      return scaled(nodes_[x.a].value / y.value, x.b);
  }
  return intern({.op = Op::div, .a = a, .b = b});
}

/// a^k, 1 <= k, by squaring; every power is a node, so squarings are shared between exponents.
NodeId Graph::integer_power(NodeId a, int exponent) {
  if (exponent == 1) return a;
  const NodeId half = integer_power(a, exponent / 2), square = product(half, half);
  return exponent % 2 == 0 ? square : product(square, a);
}

NodeId Graph::power(NodeId a, NodeId b) {
  if (is_constant(a, 1)) return a;
  const double exponent = nodes_[b].value, size = std::abs(exponent);
  if (!is_constant(b) || 2 * size != std::floor(2 * size) || size > largest_product)
    return intern({.op = Op::pow, .a = a, .b = b});
  const int whole = static_cast<int>(size);
  NodeId result = whole > 0 ? integer_power(a, whole) : constant(1);
  if (size != whole) result = product(result, unary(Op::sqrt, a));
  return exponent < 0 ? div(constant(1), result) : result;
}

/// Users before arguments, in a time that grows with the nodes of f, however many the graph has.
std::vector<NodeId> nodes_of(const Graph& graph, NodeId f) {
  std::vector<NodeId> waiting{f}, nodes;
  const auto wait = [&](NodeId id) {
    waiting.push_back(id);
    std::ranges::push_heap(waiting);
  };
  while (!waiting.empty()) {
    const NodeId id = waiting.front();
    std::ranges::pop_heap(waiting);
    waiting.pop_back();
    if (!nodes.empty() && nodes.back() == id) continue;  // an argument of several
    nodes.push_back(id);
    const Node& node = graph[id];
    if (arity(node.op) > 0) wait(node.a);
    if (arity(node.op) > 1) wait(node.b);
  }
  std::ranges::reverse(nodes);
  return nodes;
}

std::vector<std::uint32_t> inputs_of(const Graph& graph, NodeId f) {
  std::vector<std::uint32_t> inputs;
  for (const NodeId id : nodes_of(graph, f))
    if (graph[id].op == Op::input) inputs.push_back(graph[id].index);
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

NodeId substitute(Graph& graph, NodeId f, std::span<const NodeId> replacement) {
  std::vector<NodeId> image(f + 1);
  for (const NodeId id : nodes_of(graph, f)) {
    const Node node = graph[id];
    switch (arity(node.op)) {
      case 1:
        image[id] = graph.unary(node.op, image[node.a]);
        break;
      case 2:
        image[id] = graph.binary(node.op, image[node.a], image[node.b]);
        break;
      default:
        if (node.op == Op::input && node.index >= replacement.size())
          throw std::invalid_argument("input " + std::to_string(node.index) + " has no replacement among " +
                                      std::to_string(replacement.size()));
        image[id] = node.op == Op::input ? replacement[node.index] : id;
    }
  }
  return image[f];
}

template double evaluate(const Graph&, NodeId, std::span<const double>);

}  // namespace extremal
