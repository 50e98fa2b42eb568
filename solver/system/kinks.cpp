#include "system/kinks.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "system/tape_lagrangian.hpp"

namespace extremal {

bool has_kink(Op op) { return op == Op::abs || op == Op::min || op == Op::max || op == Op::step; }

namespace {

/// The body of a term in a graph of its own.
struct Body {
  Graph graph;
  NodeId value = 0;
  std::vector<NodeId> kinks;  ///< nodes abs, min, max and step
};

Body copy_body(const LagrangianGraph& l, const Term& term) {
  Body body;
  std::unordered_map<NodeId, NodeId> image;
  for (const NodeId id : nodes_of(l.graph, term.body)) {
    const Node n = l.graph[id];
    if (n.op == Op::constant)
      image[id] = body.graph.constant(n.value);
    else if (n.op == Op::input)
      image[id] = body.graph.input(n.index);
    else
      image[id] = arity(n.op) == 1 ? body.graph.unary(n.op, image[n.a])
                                   : body.graph.binary(n.op, image[n.a], image[n.b]);
  }
  body.value = image[term.body];
  for (const NodeId id : nodes_of(body.graph, body.value))
    if (has_kink(body.graph[id].op)) body.kinks.push_back(id);
  return body;
}

/// The value that a kink would have if it went on smoothly beyond its surface.
NodeId beyond(Graph& graph, NodeId kink) {
  const Node n = graph[kink];
  if (n.op == Op::abs) return graph.unary(Op::neg, kink);
  return graph.binary(n.op == Op::max ? Op::min : Op::max, n.a, n.b);
}

/// Of a base that would be negative beyond the surface this is not a number: such a base vanishes on the
/// surface, and goes on as zero.
bool needs_positive(const Graph& graph, const Node& n) {
  return n.op == Op::sqrt ||
         (n.op == Op::pow && !(graph.is_constant(n.b) && graph[n.b].value == std::floor(graph[n.b].value)));
}

/// The value of the body less that which it would have if the kink went on smoothly beyond its surface.
NodeId odd_part(Body& body, NodeId kink) {
  Graph& graph = body.graph;
  std::unordered_map<NodeId, NodeId> image;
  for (const NodeId id : nodes_of(graph, body.value)) {
    const Node n = graph[id];
    if (id == kink) {
      image[id] = beyond(graph, kink);
    } else if (arity(n.op) == 0) {
      image[id] = id;
    } else {
      const bool cut = needs_positive(graph, n) && image[n.a] != n.a;
      const NodeId a = cut ? graph.binary(Op::max, image[n.a], graph.constant(0)) : image[n.a];
      image[id] = arity(n.op) == 1 ? graph.unary(n.op, a) : graph.binary(n.op, a, image[n.b]);
    }
  }
  return graph.sub(body.value, image[body.value]);
}

/// The expressions of one kink, the same for all rows of a term.
struct Expressions {
  NodeId u, odd;
};

Expressions expressions(Body& body, NodeId kink) {
  const Node n = body.graph[kink];
  if (n.op == Op::step) return {body.graph.sub(n.a, n.b), body.graph.constant(0)};
  return {n.op == Op::abs ? n.a : body.graph.sub(n.a, n.b), odd_part(body, kink)};
}

/// Of the inputs of an expression in one row: whether one is a coordinate or the time, and a velocity.
struct Dependence {
  bool state = false, velocity = false;
};

Dependence dependence(const LagrangianGraph& l, const Body& body, NodeId u,
                      std::span<const std::uint32_t> row) {
  const auto n = static_cast<std::uint32_t>(l.coordinates);
  Dependence result;
  for (const std::uint32_t input : inputs_of(body.graph, u)) {
    result.state |= row[input] <= 2 * n;
    result.velocity |= row[input] >= n && row[input] < 2 * n;
  }
  return result;
}

std::shared_ptr<const Lagrangian> as_lagrangian(const LagrangianGraph& l, const Body& body, NodeId value,
                                                std::span<const std::uint32_t> row) {
  LagrangianGraph result;
  result.coordinates = l.coordinates;
  result.graph = body.graph;
  result.uniforms = l.uniforms;
  result.parameters = l.replaceable ? l.parameters : 0;
  result.replaceable = l.replaceable;
  result.terms.push_back({value, static_cast<int>(row.size()), {row.begin(), row.end()}});
  return std::make_shared<TapeLagrangian>(result);
}

NodeId by_time(const LagrangianGraph& l, Body& body, NodeId u, std::span<const std::uint32_t> row) {
  std::vector<std::uint32_t> times;
  for (std::uint32_t k = 0; k < row.size(); ++k)
    if (row[k] == 2u * l.coordinates) times.push_back(k);
  NodeId sum = body.graph.constant(0);
  for (const NodeId slope : gradient(body.graph, u, times)) sum = body.graph.add(sum, slope);
  return sum;
}

}  // namespace

std::shared_ptr<const Kinks> Kinks::with(std::span<const double> parameters) const {
  std::vector<KinkSurface> surfaces = surfaces_;
  for (KinkSurface& surface : surfaces)
    for (auto* function : {&surface.u, &surface.u_by_time, &surface.odd})
      if (!(*function = (*function)->with(parameters))) return nullptr;
  return std::make_shared<const Kinks>(std::move(surfaces));
}

std::shared_ptr<const Kinks> find_kinks(const LagrangianGraph& l) {
  NodeId first = 0;
  while (first < l.graph.size() && !has_kink(l.graph[first].op)) ++first;
  if (first == l.graph.size()) return nullptr;
  std::vector<KinkSurface> surfaces;
  for (const Term& term : l.terms) {
    Body body = copy_body(l, term);
    for (const NodeId kink : body.kinks) {
      const Expressions found = expressions(body, kink);
      for (int r = 0; r < term.rows(); ++r) {
        const std::span<const std::uint32_t> row(term.table.data() + static_cast<std::size_t>(r) * term.arity,
                                                 term.arity);
        const auto [state, velocity] = dependence(l, body, found.u, row);
        if (!state) continue;
        surfaces.push_back({.u = as_lagrangian(l, body, found.u, row),
                            .u_by_time = as_lagrangian(l, body, by_time(l, body, found.u, row), row),
                            .odd = as_lagrangian(l, body, found.odd, row),
                            .by_velocity = velocity});
      }
    }
  }
  return surfaces.empty() ? nullptr : std::make_shared<const Kinks>(std::move(surfaces));
}

}  // namespace extremal
