#include "system/algebra.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace extremal {

namespace {

/// Products of more bases than this are not taken apart: it bounds the work on long products.
constexpr std::size_t most_bases = 6;
constexpr int most_halves = 32;  ///< powers beyond are left to pow

/// Where max(0, u) is zero so are its derivatives, and with them those of its powers above 1. A negative
/// power as a factor of a derivative must then be finite: it is that of no less than `above_zero`.
constexpr double above_zero = 1e-150;
bool vanishes_widely(Op op) { return op == Op::min || op == Op::max; }

bool is_odd(Op op) {
  return op == Op::sin || op == Op::tan || op == Op::asin || op == Op::atan || op == Op::sinh ||
         op == Op::tanh;
}

bool is_even(Op op) { return op == Op::cos || op == Op::cosh || op == Op::abs; }

}  // namespace

Algebra::Algebra(Graph& graph, std::vector<bool> uniform)
    : graph_(graph), one_(graph.constant(1)), uniform_inputs_(std::move(uniform)) {}

Scaled Algebra::scaled(double factor, NodeId node) const {
  const Node& n = graph_[node];
  if (n.op == Op::constant) return {factor * n.value, one_};
  if (n.op == Op::neg) return {-factor, n.a};
  return {factor, node};
}

bool Algebra::uniform(NodeId node) {
  for (auto id = static_cast<NodeId>(uniform_.size()); id <= node; ++id) {
    const Node& n = graph_[id];
    if (n.op == Op::input) {
      uniform_.push_back(n.index < uniform_inputs_.size() && uniform_inputs_[n.index]);
    } else {
      const int arguments = arity(n.op);
      uniform_.push_back((arguments < 1 || uniform_[n.a]) && (arguments < 2 || uniform_[n.b]));
    }
  }
  return uniform_[node];
}

Scaled Algebra::add(Scaled a, Scaled b) {
  if (a.zero()) return b;
  if (b.zero()) return a;
  if (a.node == b.node) return {a.factor + b.factor, a.node};
  if (a.factor == b.factor) return scaled(a.factor, graph_.add(a.node, b.node));
  if (a.factor == -b.factor) {  // oriented, so that a − b and b − a are one node
    if (a.node > b.node) std::swap(a, b);
    return scaled(a.factor, graph_.sub(a.node, b.node));
  }
  const NodeId x = node({std::abs(a.factor), a.node}), y = node({std::abs(b.factor), b.node});
  if ((a.factor < 0) == (b.factor < 0)) return {a.factor < 0 ? -1.0 : 1.0, graph_.add(x, y)};
  return {1, a.factor < 0 ? graph_.sub(y, x) : graph_.sub(x, y)};
}

Algebra::Product Algebra::product(NodeId node) const {
  if (node == one_) return {};
  const auto known = products_.find(node);
  return known != products_.end() ? known->second : Product{1, {{node, 2}}};
}

/// Uniform factors, then negative powers (shared by most terms of a Hessian), then the rest.
bool Algebra::before(NodeId a, int halves_a, NodeId b, int halves_b) {
  const auto rank = [&](NodeId base, int halves) { return uniform(base) ? 0 : halves < 0 ? 1 : 2; };
  const int rank_a = rank(a, halves_a), rank_b = rank(b, halves_b);
  return rank_a != rank_b ? rank_a < rank_b : a < b;
}

void Algebra::include(Product& product, Power power) {
  const auto same = std::find_if(product.powers.begin(), product.powers.end(),
                                 [&](const Power& p) { return p.base == power.base; });
  if (same == product.powers.end()) {
    product.powers.push_back(power);
  } else if ((same->halves += power.halves) == 0) {
    product.powers.erase(same);
  }
}

Scaled Algebra::multiply(Scaled a, Scaled b) {
  if (a.zero() || b.zero()) return {};
  Product result = product(a.node);
  const Product other = product(b.node);
  for (const Power& p : other.powers) include(result, p);
  const double factor = a.factor * b.factor * result.factor * other.factor;
  if (!std::isnormal(factor)) return scaled(1, graph_.mul(node(a), node(b)));
  if (result.powers.size() > most_bases) return {a.factor * b.factor, graph_.mul(a.node, b.node)};
  std::sort(result.powers.begin(), result.powers.end(),
            [&](const Power& x, const Power& y) { return before(x.base, x.halves, y.base, y.halves); });
  return {factor, build(1, result.powers)};
}

Scaled Algebra::power(Scaled a, int halves) {
  if (a.node == one_) return scaled(1, graph_.pow(node(a), graph_.constant(0.5 * halves)));
  if (halves % 2 != 0) return {1, power_node({node(a), halves})};
  Product result = product(a.node);
  const double factor = std::pow(a.factor * result.factor, halves / 2);
  if (!std::isnormal(factor)) return {1, power_node({node(a), halves})};
  for (Power& p : result.powers) p.halves *= halves / 2;
  std::sort(result.powers.begin(), result.powers.end(),
            [&](const Power& x, const Power& y) { return before(x.base, x.halves, y.base, y.halves); });
  return {factor, build(1, result.powers)};
}

Scaled Algebra::reciprocal(Scaled a) {
  if (a.zero() || a.node == one_) return scaled(1, graph_.div(one_, node(a)));
  return power(a, -2);
}

/// A power from repeated products of the smallest one: of base^(-1/2) if there is a square root. Each is
/// built once, so that the powers 1 … k take a time of order k log k.
NodeId Algebra::power_node(Power p) {
  if (p.halves == 2) return p.base;
  const std::uint64_t key = std::uint64_t{p.base} << 32 | static_cast<std::uint32_t>(p.halves);
  if (const auto known = powers_.find(key); known != powers_.end()) return known->second;
  const bool odd = p.halves % 2 != 0;
  NodeId result = 0;
  if (p.halves == 1) {
    if (rooted_.insert(p.base).second) powers_.clear();  // others are built of the root from here on
    result = graph_.unary(Op::sqrt, p.base);
  } else if (p.halves == -1) {
    const bool cut = vanishes_widely(graph_[p.base].op);
    const NodeId least = graph_.constant(above_zero);
    result = graph_.div(
        one_, cut ? graph_.unary(Op::sqrt, graph_.binary(Op::max, p.base, least)) : power_node({p.base, 1}));
  } else if (p.halves == -2 && !rooted_.contains(p.base)) {
    result = graph_.div(one_, p.base);
  } else if (p.halves > 0 && odd) {
    result = graph_.mul(power_node({p.base, p.halves - 1}), power_node({p.base, 1}));
  } else {
    const int unit = p.halves > 0 ? 2 : odd || rooted_.contains(p.base) ? -1 : -2, count = p.halves / unit;
    const int half = count / 2 * unit;
    result = graph_.mul(power_node({p.base, p.halves - half}), power_node({p.base, half}));
  }
  remember(result, 1, {p});
  powers_.emplace(key, result);
  return result;
}

NodeId Algebra::build(double factor, const std::vector<Power>& powers) {
  NodeId result = graph_.constant(factor);
  std::vector<Power> done;
  for (const Power& p : powers) {
    result = graph_.mul(result, power_node(p));
    done.push_back(p);
    remember(result, factor, done);
  }
  return result;
}

void Algebra::remember(NodeId node, double factor, const std::vector<Power>& powers) {
  if (powers.size() == 1 && powers[0].base == node) return;
  products_.try_emplace(node, Product{factor, powers});
}

NodeId Algebra::node(Scaled a) {
  if (a.zero()) return graph_.constant(0);
  const double size = std::abs(a.factor);
  if (a.node == one_) return graph_.constant(a.factor);
  NodeId result = a.node;
  if (size != 1) {
    const Product p = product(a.node);
    result = std::isnormal(size * p.factor) ? build(size * p.factor, p.powers)
                                            : graph_.mul(graph_.constant(size), a.node);
  }
  return a.factor < 0 ? graph_.unary(Op::neg, result) : result;
}

Scaled Algebra::unary(Op op, Scaled a) {
  if (op == Op::neg) return -a;
  if (a.zero() || a.node == one_) return scaled(1, graph_.unary(op, node(a)));
  if (op == Op::sqrt) return power(a, 1);
  if (op == Op::abs) return {std::abs(a.factor), graph_.unary(op, a.node)};
  if (a.factor < 0 && is_odd(op)) return -unary(op, -a);
  if (a.factor < 0 && is_even(op)) return unary(op, -a);
  return scaled(1, graph_.unary(op, node(a)));
}

Scaled Algebra::binary(Op op, Scaled a, Scaled b) {
  switch (op) {
    case Op::add:
      return add(a, b);
    case Op::sub:
      return subtract(a, b);
    case Op::mul:
      return multiply(a, b);
    case Op::div:
      return a.zero() && b.zero() ? Scaled{1, graph_.div(node(a), node(b))} : multiply(a, reciprocal(b));
    default:
      break;
  }
  const double halves = 2 * b.factor;
  const bool number = b.node == one_ && !b.zero() && !a.zero();
  if (op == Op::pow && number && halves == std::round(halves) && std::abs(halves) <= most_halves)
    return power(a, static_cast<int>(halves));
  if (op == Op::pow && number && halves < 0 && vanishes_widely(graph_[a.node].op))
    return scaled(1, graph_.pow(graph_.binary(Op::max, node(a), graph_.constant(above_zero)), node(b)));
  return scaled(1, graph_.binary(op, node(a), node(b)));
}

Scaled Algebra::import(const Graph& from, NodeId f, std::span<const Scaled> replacement) {
  std::unordered_map<NodeId, Scaled> image;
  for (const NodeId id : nodes_of(from, f)) {
    const Node n = from[id];
    if (n.op == Op::constant) {
      image[id] = scaled(1, graph_.constant(n.value));
    } else if (n.op == Op::input) {
      if (!replacement.empty() && n.index >= replacement.size())
        throw std::invalid_argument("input " + std::to_string(n.index) + " of a term that has " +
                                    std::to_string(replacement.size()));
      image[id] = replacement.empty() ? input(n.index) : replacement[n.index];
    } else {
      const Scaled a = image[n.a];
      image[id] = arity(n.op) == 1 ? unary(n.op, a) : binary(n.op, a, image[n.b]);
    }
  }
  return image[f];
}

}  // namespace extremal
