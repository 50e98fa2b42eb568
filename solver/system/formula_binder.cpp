#include "system/formula_binder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace extremal::formula {

namespace {

constexpr std::size_t most_unrolled = 500'000;
constexpr std::size_t most_entries = 50'000'000;  ///< of one table, 200 MB

bool is_constant(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [&](double value) { return value == values[0]; });
}

}  // namespace

Binder::Binder(const Names& names, LagrangianGraph& target)
    : names_(names), target_(target), evaluator_(names) {
  target.coordinates = names.elements;
  target.uniforms = names.active;
  target.parameters = static_cast<int>(names.active.size());
  target.replaceable = names.replaceable;
}

NodeId Binder::bind(TermBuilder& builder, const Formula& formula, std::uint32_t id, const Scope& scope) {
  const Syntax& node = formula.nodes[id];
  const auto links = formula.children(node);
  Graph& graph = target_.graph;
  if (unrolling_ > 0 && ++unrolled_ > most_unrolled)
    fail(
        formula, node.offset,
        fmt::format("a sum inside a function or a product of sums is written out term by term, and here that "
                    "takes more than {} operations",
                    most_unrolled));
  if (builder.rows() > 1 && (builder.columns() + 1) * builder.rows() > most_entries)
    fail(formula, node.offset,
         fmt::format(
             "a sum of {} terms that read more than {} numbers each is too large: {} entries are the most",
             builder.rows(), builder.columns(), most_entries));
  if (node.numeric) {
    const Factor number{&formula, id, false, scope};
    return product(builder, {&number, 1}, graph.constant(1));
  }
  const auto part = [&](std::size_t k) { return bind(builder, formula, links[k].node, scope); };
  switch (node.form) {
    case Form::number:
      return graph.constant(node.value);
    case Form::reference:
      return reference(builder, formula, node, scope);
    case Form::negative:
      return graph.unary(Op::neg, part(0));
    case Form::total:
      return total(builder, formula, links, scope);
    case Form::product: {
      std::vector<Factor> factors;
      for (const Link link : links) factors.push_back({&formula, link.node, link.inverse, scope});
      return product(builder, factors, graph.constant(1));
    }
    case Form::power: {
      const NodeId base = part(0);
      return graph.pow(base, part(1));
    }
    case Form::series:
      return series(builder, formula, node, scope);
    case Form::call: {
      if (node.meaning == Meaning::definition_start || node.meaning == Meaning::definition_end)
        return definition(builder, node.id, node.meaning == Meaning::definition_end);
      if (node.meaning != Meaning::none) return coordinate(builder, formula, node, scope);
      const NodeId first = part(0);
      if (node.op == Op::step) return graph.binary(Op::step, first, graph.constant(0));
      return links.size() > 1 ? graph.binary(node.op, first, part(1)) : graph.unary(node.op, first);
    }
  }
  return 0;
}

NodeId Binder::total(TermBuilder& builder, const Formula& formula, std::span<const Link> links,
                     const Scope& scope) {
  Graph& graph = target_.graph;
  NodeId sum = graph.constant(0);
  std::vector<Link> numeric;
  for (const Link link : links) {
    if (formula.nodes[link.node].numeric) {
      numeric.push_back(link);
    } else {
      const NodeId part = bind(builder, formula, link.node, scope);
      sum = link.inverse ? graph.sub(sum, part) : graph.add(sum, part);
    }
  }
  if (numeric.empty()) return sum;
  const std::vector<double> values =
      numbers(builder, formula, formula.nodes[numeric[0].node], [&](std::size_t row) {
        double value = 0;
        builder.read(scope, row, indices_);
        for (const Link link : numeric) {
          const double part = evaluator_.finite(formula, link.node, indices_);
          value += link.inverse ? -part : part;
        }
        return value;
      });
  return graph.add(sum, uniform(builder, values));
}

NodeId Binder::product(TermBuilder& builder, std::span<const Factor> factors, NodeId seed) {
  Graph& graph = target_.graph;
  NodeId divisor = graph.constant(1);
  std::vector<const Factor*> numeric;
  for (const Factor& factor : factors) {
    if (factor.formula->nodes[factor.node].numeric) {
      numeric.push_back(&factor);
    } else {
      NodeId& side = factor.inverse ? divisor : seed;
      side = graph.mul(side, bind(builder, *factor.formula, factor.node, factor.scope));
    }
  }
  if (numeric.empty()) return graph.div(seed, divisor);
  const auto gathered = [&](bool inverse) {
    const Factor& first = *numeric[0];
    return numbers(builder, *first.formula, first.formula->nodes[first.node], [&](std::size_t row) {
      double value = 1;
      for (const Factor* factor : numeric) {
        if (factor->inverse != inverse) continue;
        builder.read(factor->scope, row, indices_);
        value *= evaluator_.finite(*factor->formula, factor->node, indices_);
        if (inverse && value == 0)
          fail(*factor->formula, factor->formula->nodes[factor->node].offset, "division by zero");
      }
      return value;
    });
  };
  std::vector<double> over = gathered(false), under = gathered(true);
  if (is_constant(over) && is_constant(under))  // x/3 is rounded once, and not at all in extended precision
    return graph.div(graph.div(graph.mul(graph.constant(over[0]), seed), graph.constant(under[0])), divisor);
  for (std::size_t row = 0; row < over.size(); ++row) over[row] /= under[row];
  return graph.div(graph.mul(uniform(builder, over), seed), divisor);
}

NodeId Binder::reference(TermBuilder& builder, const Formula& formula, const Syntax& node,
                         const Scope& scope) {
  const auto n = static_cast<std::uint32_t>(names_.elements);
  switch (node.meaning) {
    case Meaning::coordinate:
      return coordinate(builder, formula, node, scope);
    case Meaning::time:
      return same_input(builder, 2 * n);
    case Meaning::active:
      return element(builder, formula, node, 2 * n + 1 + node.id, names_.find(formula.name(node))->count,
                     scope);
    case Meaning::definition: {
      const NodeId value = definition(builder, node.id, at_end_);
      return node.velocity ? velocity(builder, value) : value;
    }
    default:
      fail(formula, node.offset, fmt::format("'{}' cannot stand here", formula.name(node)));
  }
}

NodeId Binder::definition(TermBuilder& builder, int id, bool at_end) {
  const auto known = builder.definitions.find({id, at_end});
  if (known != builder.definitions.end()) return known->second;
  const Formula& formula = names_.definitions[id];
  const bool outer = std::exchange(at_end_, at_end);
  const NodeId value = bind(builder, formula, formula.root, {});
  at_end_ = outer;
  builder.definitions.emplace(std::pair(id, at_end), value);
  return value;
}

/// dX/dt = Σ ∂X/∂q_a q_a' + ∂X/∂t along a motion. All entries of a column are coordinates, or all are t, or
/// none is either.
NodeId Binder::velocity(TermBuilder& builder, NodeId value) {
  Graph& graph = target_.graph;
  const auto n = static_cast<std::uint32_t>(names_.elements);
  const std::vector<std::uint32_t> inputs = inputs_of(graph, value);
  const std::vector<NodeId> slopes = gradient(graph, value, inputs);
  NodeId sum = graph.constant(0);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    std::vector<std::uint32_t> column = builder.column(inputs[k]);
    if (column[0] == 2 * n) sum = graph.add(sum, slopes[k]);
    if (column[0] >= n) continue;
    for (std::uint32_t& entry : column) entry += n;
    sum = graph.add(sum, graph.mul(slopes[k], builder.input(std::move(column))));
  }
  return sum;
}

NodeId Binder::coordinate(TermBuilder& builder, const Formula& formula, const Syntax& node,
                          const Scope& scope) {
  const Coordinate& declared = names_.coordinates[node.id];
  const bool second = node.velocity || node.momentum || node.meaning == Meaning::end || at_end_;
  const std::uint32_t first = declared.first + (second ? names_.elements : 0);
  return element(builder, formula, node, first, declared.count, scope);
}

/// Of an array whose first element is the global input `first`; if the node has no index, that itself.
NodeId Binder::element(TermBuilder& builder, const Formula& formula, const Syntax& node, std::uint32_t first,
                       int count, const Scope& scope) {
  if (!node.indexed) return same_input(builder, first);
  std::vector<std::uint32_t> column(builder.rows());
  for (std::size_t row = 0; row < column.size(); ++row) {
    builder.read(scope, row, indices_);
    column[row] = first + evaluator_.element(formula, node, count, indices_);
  }
  return builder.input(std::move(column));
}

NodeId Binder::same_input(TermBuilder& builder, std::uint32_t global) {
  return builder.input(std::vector<std::uint32_t>(builder.rows(), global));
}

/// Σ body for the values of the index, term by term. The bounds are the same in all rows.
NodeId Binder::series(TermBuilder& builder, const Formula& formula, const Syntax& node, const Scope& scope) {
  const Unrolling unrolling(*this);
  const auto links = formula.children(node);
  builder.read(scope, 0, indices_);
  const long from = evaluator_.integer(formula, links[0].node, indices_, "the lower bound of a sum");
  const long to = evaluator_.integer(formula, links[1].node, indices_, "the upper bound of a sum");
  NodeId sum = target_.graph.constant(0);
  Scope inner = scope;
  inner.emplace_back();
  for (long i = from; i <= to; ++i) {
    inner.back().value = static_cast<double>(i);
    sum = target_.graph.add(sum, bind(builder, formula, links[2].node, inner));
  }
  return sum;
}

template <class ValueOfRow>
std::vector<double> Binder::numbers(TermBuilder& builder, const Formula& formula, const Syntax& node,
                                    ValueOfRow value) {
  std::vector<double> values(builder.rows());
  for (std::size_t row = 0; row < values.size(); ++row) {
    values[row] = value(row);
    if (!std::isfinite(values[row]))
      fail(formula, node.offset, "the numbers here do not combine to a finite one");
  }
  return values;
}

NodeId Binder::uniform(TermBuilder& builder, std::span<const double> values) {
  if (is_constant(values)) return target_.graph.constant(values[0]);
  const auto first = static_cast<std::uint32_t>(2 * names_.elements + 1);
  std::vector<std::uint32_t> column;
  for (const double value : values) {
    const auto next = first + static_cast<std::uint32_t>(target_.uniforms.size());
    const auto [it, added] = uniforms_.try_emplace(std::bit_cast<std::uint64_t>(value), next);
    if (added) target_.uniforms.push_back(value);
    column.push_back(it->second);
  }
  return builder.input(std::move(column));
}

}  // namespace extremal::formula
