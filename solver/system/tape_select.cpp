#include "system/tape_select.hpp"

#include <utility>

namespace extremal {

namespace {

Selection of_one(Code code, NodeId a) { return {code, 1, {a}}; }
Selection of_two(Code code, NodeId a, NodeId b) { return {code, 2, {a, b}}; }
Selection of_three(Code code, NodeId a, NodeId b, NodeId c) { return {code, 3, {a, b, c}}; }

Selection with(Selection selection, Scaled scalar) {
  selection.scalar = scalar;
  selection.has_scalar = true;
  return selection;
}

Code function_code(Op op) {
  switch (op) {
    case Op::pow:
      return Code::power;
    case Op::atan2:
      return Code::arctangent2;
    case Op::min:
      return Code::minimum;
    case Op::max:
      return Code::maximum;
    case Op::step:
      return Code::step;
    case Op::abs:
      return Code::absolute;
    case Op::sqrt:
      return Code::square_root;
    case Op::exp:
      return Code::exponential;
    case Op::log:
      return Code::logarithm;
    case Op::sin:
      return Code::sine;
    case Op::cos:
      return Code::cosine;
    case Op::tan:
      return Code::tangent;
    case Op::asin:
      return Code::arcsine;
    case Op::acos:
      return Code::arccosine;
    case Op::atan:
      return Code::arctangent;
    case Op::sinh:
      return Code::hyperbolic_sine;
    case Op::cosh:
      return Code::hyperbolic_cosine;
    default:
      return Code::hyperbolic_tangent;
  }
}

}  // namespace

int reads(Code code) {
  switch (code) {
    case Code::fill:
      return 0;
    case Code::add:
    case Code::subtract:
    case Code::multiply:
    case Code::multiply_negate:
    case Code::divide:
    case Code::scale_add:
    case Code::scale_sub:
    case Code::multiply_scalar:
    case Code::scalar_multiply:
    case Code::step:
    case Code::minimum:
    case Code::maximum:
    case Code::power:
    case Code::arctangent2:
      return 2;
    case Code::multiply_add:
    case Code::multiply_sub:
    case Code::sub_multiply:
    case Code::negate_all:
      return 3;
    default:
      return 1;
  }
}

Selector::Selector(const Kernel& kernel, std::span<const Root> roots)
    : graph_(kernel.graph), uses_(kernel.graph.size()), uniform_(kernel.graph.size()) {
  for (NodeId id = 0; id < graph_.size(); ++id) {
    const Node& n = graph_[id];
    const int arguments = arity(n.op);
    uniform_[id] = n.op == Op::input ? kernel.is_uniform(n.index)
                                     : (arguments < 1 || uniform_[n.a]) && (arguments < 2 || uniform_[n.b]);
  }
  for (const Root& root : roots) ++uses_[root.value.node];
  for (auto id = static_cast<NodeId>(graph_.size()); id-- > 0;) {
    const Node& n = graph_[id];
    if (uses_[id] == 0 || uniform_[id]) continue;
    if (arity(n.op) > 0) ++uses_[n.a];
    if (arity(n.op) > 1) ++uses_[n.b];
  }
}

bool Selector::fusable(NodeId node) const {
  return graph_[node].op == Op::mul && !uniform_[node] && uses_[node] == 1;
}

/// Fusable, and without a uniform factor.
bool Selector::fusable_plain(NodeId node) const {
  return fusable(node) && !uniform_[graph_[node].a] && !uniform_[graph_[node].b];
}

Selection Selector::accumulate(NodeId node, double sign, NodeId c) const {
  const Node& n = graph_[node];
  if (uniform_[n.a]) return with(of_two(Code::scale_add, n.b, c), {sign, n.a});
  if (uniform_[n.b]) return with(of_two(Code::scale_add, n.a, c), {sign, n.b});
  return of_three(sign > 0 ? Code::multiply_add : Code::sub_multiply, n.a, n.b, c);
}

Selection Selector::select_sum(NodeId a, NodeId b) const {
  if (uniform_[a]) std::swap(a, b);
  if (uniform_[b]) {
    if (fusable_plain(a)) return with(of_two(Code::multiply_scalar, graph_[a].a, graph_[a].b), {1, b});
    return with(of_one(Code::add_scalar, a), {1, b});
  }
  if (fusable(b)) return accumulate(b, 1, a);
  if (fusable(a)) return accumulate(a, 1, b);
  return of_two(Code::add, a, b);
}

Selection Selector::select_difference(NodeId a, NodeId b) const {
  if (uniform_[b]) {
    if (fusable_plain(a)) return with(of_two(Code::multiply_scalar, graph_[a].a, graph_[a].b), {-1, b});
    return with(of_one(Code::add_scalar, a), {-1, b});
  }
  if (uniform_[a]) {
    if (fusable_plain(b)) return with(of_two(Code::scalar_multiply, graph_[b].a, graph_[b].b), {1, a});
    return with(of_one(Code::subtract_from, b), {1, a});
  }
  if (fusable(b)) return accumulate(b, -1, a);
  if (!fusable(a)) return of_two(Code::subtract, a, b);
  Selection negated = accumulate(a, -1, b);  // b − a
  negate(negated);
  return negated;
}

Selection Selector::select_product(NodeId a, NodeId b) const {
  if (uniform_[a]) return with(of_one(Code::scale, b), {1, a});
  if (uniform_[b]) return with(of_one(Code::scale, a), {1, b});
  return of_two(Code::multiply, a, b);
}

Selection Selector::select(NodeId node) const {
  const Node& n = graph_[node];
  if (uniform_[node]) return with({Code::fill}, {1, node});
  switch (n.op) {
    case Op::add:
      return select_sum(n.a, n.b);
    case Op::sub:
      return select_difference(n.a, n.b);
    case Op::mul:
      return select_product(n.a, n.b);
    case Op::neg: {
      if (!fusable(n.a)) return of_one(Code::negate, n.a);
      Selection product = select_product(graph_[n.a].a, graph_[n.a].b);
      negate(product);
      return product;
    }
    case Op::div: {
      if (!graph_.is_constant(n.a, 1)) return of_two(Code::divide, n.a, n.b);
      const bool root = graph_[n.b].op == Op::sqrt && uses_[n.b] == 1;
      return root ? of_one(Code::reciprocal_root, graph_[n.b].a) : of_one(Code::reciprocal, n.b);
    }
    default:
      return arity(n.op) == 2 ? of_two(function_code(n.op), n.a, n.b) : of_one(function_code(n.op), n.a);
  }
}

bool negate(Selection& s) {
  const auto change = [&](Code code, bool scalar) {
    s.code = code;
    if (scalar) s.scalar.factor = -s.scalar.factor;
    return true;
  };
  switch (s.code) {
    case Code::fill:
    case Code::scale:
      return change(s.code, true);
    case Code::copy:
      return change(Code::negate, false);
    case Code::negate:
      return change(Code::copy, false);
    case Code::subtract:
      std::swap(s.arguments[0], s.arguments[1]);
      return true;
    case Code::add_scalar:
      return change(Code::subtract_from, true);
    case Code::subtract_from:
      return change(Code::add_scalar, true);
    case Code::multiply:
      return change(Code::multiply_negate, false);
    case Code::multiply_add:
      return change(Code::negate_all, false);
    case Code::multiply_sub:
      return change(Code::sub_multiply, false);
    case Code::sub_multiply:
      return change(Code::multiply_sub, false);
    case Code::scale_add:
      return change(Code::scale_sub, true);
    case Code::scale_sub:
      return change(Code::scale_add, true);
    case Code::multiply_scalar:
      return change(Code::scalar_multiply, true);
    case Code::scalar_multiply:
      return change(Code::multiply_scalar, true);
    default:
      return false;
  }
}

}  // namespace extremal
