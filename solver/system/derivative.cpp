#include "system/derivative.hpp"

#include <algorithm>
#include <unordered_map>

namespace extremal {

namespace {

/// One reverse sweep over the nodes of f.
class Sweep {
 public:
  Sweep(Algebra& algebra, Scaled f, const std::vector<bool>& wanted);
  std::vector<Partial> run();

 private:
  Scaled one(NodeId node) const { return {1, node}; }
  Scaled times(Scaled a, Scaled b) { return algebra_.multiply(a, b); }
  Scaled over(Scaled a, Scaled b) { return algebra_.multiply(a, algebra_.reciprocal(b)); }
  Scaled square(Scaled a) { return algebra_.multiply(a, a); }
  Scaled number(double value) const { return algebra_.constant(value); }

  void push(NodeId argument, Scaled adjoint);
  Scaled collected(std::vector<Scaled>& terms);
  void pull_binary(const Node& node, Scaled self, Scaled adjoint);
  void pull_power(const Node& node, Scaled self, Scaled adjoint);
  void pull_unary(const Node& node, Scaled self, Scaled adjoint);
  Scaled slope(Op op, Scaled x, Scaled self);

  Algebra& algebra_;
  std::vector<NodeId> nodes_;                       ///< of f, arguments first
  std::unordered_map<NodeId, std::size_t> active_;  ///< position in adjoints_ of those with a wanted input
  std::vector<std::vector<Scaled>> adjoints_;       ///< a sum for each active node
};

Sweep::Sweep(Algebra& algebra, Scaled f, const std::vector<bool>& wanted)
    : algebra_(algebra), nodes_(nodes_of(algebra.graph(), f.node)) {
  for (const NodeId id : nodes_) {
    const Node& n = algebra_.graph()[id];
    const bool active = n.op == Op::input ? n.index < wanted.size() && wanted[n.index]
                                          : (arity(n.op) > 0 && active_.contains(n.a)) ||
                                                (arity(n.op) > 1 && active_.contains(n.b));
    if (active) active_.emplace(id, active_.size());
  }
  adjoints_.resize(active_.size());
  push(f.node, number(f.factor));
}

void Sweep::push(NodeId argument, Scaled adjoint) {
  const auto at = active_.find(argument);
  if (at != active_.end() && !adjoint.zero()) adjoints_[at->second].push_back(adjoint);
}

/// The sum, with equal nodes collected: this turns the product rule on powers into one term.
Scaled Sweep::collected(std::vector<Scaled>& terms) {
  std::sort(terms.begin(), terms.end(), [](Scaled a, Scaled b) { return a.node < b.node; });
  Scaled sum;
  for (std::size_t k = 0; k < terms.size();) {
    Scaled term = terms[k++];
    while (k < terms.size() && terms[k].node == term.node) term.factor += terms[k++].factor;
    sum = algebra_.add(sum, term);
  }
  return sum;
}

std::vector<Partial> Sweep::run() {
  std::vector<Partial> partials;
  for (auto id = nodes_.rbegin(); id != nodes_.rend(); ++id) {
    const auto at = active_.find(*id);
    if (at == active_.end()) continue;
    const Scaled adjoint = collected(adjoints_[at->second]);
    adjoints_[at->second].clear();
    if (adjoint.zero()) continue;
    const Node node = algebra_.graph()[*id];  // a copy: the graph grows
    if (node.op == Op::input) {
      partials.push_back({node.index, adjoint});
    } else if (arity(node.op) == 1) {
      pull_unary(node, one(*id), adjoint);
    } else {
      pull_binary(node, one(*id), adjoint);
    }
  }
  std::sort(partials.begin(), partials.end(),
            [](const Partial& a, const Partial& b) { return a.input < b.input; });
  return partials;
}

void Sweep::pull_binary(const Node& node, Scaled self, Scaled adjoint) {
  const Scaled a = one(node.a), b = one(node.b);
  switch (node.op) {
    case Op::add:
    case Op::sub:
      push(node.a, adjoint);
      push(node.b, node.op == Op::add ? adjoint : -adjoint);
      break;
    case Op::mul:
      push(node.a, times(adjoint, b));
      push(node.b, times(adjoint, a));
      break;
    case Op::div:  // f = a/b: df = da/b − f db/b
      if (active_.contains(node.a)) push(node.a, over(adjoint, b));
      if (active_.contains(node.b)) push(node.b, -times(adjoint, over(self, b)));
      break;
    case Op::pow:
      pull_power(node, self, adjoint);
      break;
    case Op::atan2: {  // f = atan2(a, b): df = (b da − a db)/(a² + b²)
      const Scaled common = over(adjoint, algebra_.add(square(a), square(b)));
      push(node.a, times(common, b));
      push(node.b, -times(common, a));
      break;
    }
    case Op::min:
    case Op::max: {
      const Scaled upper = algebra_.binary(Op::step, a, b), lower = algebra_.subtract(number(1), upper);
      push(node.a, times(adjoint, node.op == Op::max ? upper : lower));
      push(node.b, times(adjoint, node.op == Op::max ? lower : upper));
      break;
    }
    default:  // step is constant wherever it has a derivative
      break;
  }
}

/// f = a^b: df = b a^(b−1) da + f log(a) db. The first is not written as b f/a, which fails at a = 0.
void Sweep::pull_power(const Node& node, Scaled self, Scaled adjoint) {
  const Scaled a = one(node.a), b = algebra_.scaled(1, node.b);
  if (active_.contains(node.a)) {
    const Scaled lower = algebra_.binary(Op::pow, a, algebra_.subtract(b, number(1)));
    push(node.a, times(adjoint, times(b, lower)));
  }
  if (active_.contains(node.b)) push(node.b, times(adjoint, times(self, algebra_.unary(Op::log, a))));
}

void Sweep::pull_unary(const Node& node, Scaled self, Scaled adjoint) {
  push(node.a, node.op == Op::neg ? -adjoint : times(adjoint, slope(node.op, one(node.a), self)));
}

/// f'(x), in terms of f = `self` where that is cheaper.
Scaled Sweep::slope(Op op, Scaled x, Scaled self) {
  Algebra& g = algebra_;
  switch (op) {
    case Op::abs:
      return g.subtract(times(number(2), g.binary(Op::step, x, number(0))), number(1));
    case Op::sqrt:
      return times(number(0.5), g.reciprocal(self));
    case Op::exp:
      return self;
    case Op::log:
      return g.reciprocal(x);
    case Op::sin:
      return g.unary(Op::cos, x);
    case Op::cos:
      return -g.unary(Op::sin, x);
    case Op::tan:
      return g.add(number(1), square(self));
    case Op::asin:
      return g.reciprocal(g.unary(Op::sqrt, g.subtract(number(1), square(x))));
    case Op::acos:
      return -g.reciprocal(g.unary(Op::sqrt, g.subtract(number(1), square(x))));
    case Op::atan:
      return g.reciprocal(g.add(number(1), square(x)));
    case Op::sinh:
      return g.unary(Op::cosh, x);
    case Op::cosh:
      return g.unary(Op::sinh, x);
    default:  // tanh
      return g.subtract(number(1), square(self));
  }
}

}  // namespace

std::vector<Partial> differentiate(Algebra& algebra, Scaled f, const std::vector<bool>& wanted) {
  if (f.zero()) return {};
  return Sweep(algebra, f, wanted).run();
}

std::vector<NodeId> gradient(Graph& graph, NodeId f, std::span<const std::uint32_t> inputs) {
  std::vector<bool> wanted;
  for (const std::uint32_t k : inputs) {
    if (k >= wanted.size()) wanted.resize(k + 1);
    wanted[k] = true;
  }
  Algebra algebra(graph);
  const std::vector<Partial> partials = differentiate(algebra, algebra.import(graph, f), wanted);
  std::vector<NodeId> result;
  for (const std::uint32_t k : inputs) {
    const auto at = std::lower_bound(partials.begin(), partials.end(), k,
                                     [](const Partial& p, std::uint32_t input) { return p.input < input; });
    result.push_back(at != partials.end() && at->input == k ? algebra.node(at->value) : graph.constant(0));
  }
  return result;
}

}  // namespace extremal
