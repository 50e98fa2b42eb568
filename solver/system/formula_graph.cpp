#include "system/formula_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "system/formula_binder.hpp"

namespace extremal::formula {

namespace {

constexpr std::size_t most_rows = 10'000'000;
constexpr std::size_t most_terms = 10'000;

/// Whether a sum below the node that must be written out has bounds that differ between rows.
bool varies(const Formula& formula, std::uint32_t id, const Scope& scope) {
  const Syntax& node = formula.nodes[id];
  if (node.numeric) return false;
  const auto links = formula.children(node);
  const auto differs = [&](auto&& self, std::uint32_t bound) -> bool {
    const Syntax& part = formula.nodes[bound];
    if (part.meaning == Meaning::index)
      return part.id < static_cast<int>(scope.size()) && scope[part.id].column >= 0;
    return std::ranges::any_of(formula.children(part), [&](Link link) { return self(self, link.node); });
  };
  if (node.form == Form::series && (differs(differs, links[0].node) || differs(differs, links[1].node)))
    return true;
  return std::ranges::any_of(links, [&](Link link) { return varies(formula, link.node, scope); });
}

/// Splits L into its summands.
class Splitter {
 public:
  Splitter(const Names& names, LagrangianGraph& target)
      : names_(names), target_(target), binder_(names, target), plain_(target.graph) {}

  void split(const Formula& formula) {
    walk(plain_, formula, formula.root, {}, false);
    finish();
  }

  /// Adds Σ factor · formula over the rows of an index that both know, `from`, `from` + 1, …
  void add_rows(const Formula& formula, const Formula& factor, int from, int rows) {
    const bool single = rows == 1;
    std::vector<double> indices(rows);
    std::iota(indices.begin(), indices.end(), from);
    const Scope scope{single ? Slot{-1, indices[0]} : Slot{0, 0}};
    factors_.push_back({&factor, factor.root, false, scope});
    if (single) {
      walk(plain_, formula, formula.root, scope, false);
    } else {
      TermBuilder builder(target_.graph, rows, 1, std::move(indices));
      walk(builder, formula, formula.root, scope, false);
      if (Term term = builder.finish(); term.arity > 0) target_.terms.push_back(std::move(term));
    }
    factors_.pop_back();
  }

  /// The rest of the summands becomes the first term.
  void finish() {
    if (!target_.graph.is_constant(plain_.body(), 0) || target_.terms.empty())
      target_.terms.insert(target_.terms.begin(), plain_.finish());
  }

 private:
  /// Adds ± factors_ · node to the term being built, or to further ones where the node holds sums as
  /// summands.
  void walk(TermBuilder& builder, const Formula& formula, std::uint32_t id, const Scope& scope,
            bool negative) {
    const Syntax& node = formula.nodes[id];
    binder_.evaluator().spend(formula, node, 1);
    if (!node.additive) {
      const Link link{id};
      return emit(builder, formula, {&link, 1}, scope, negative);
    }
    const auto links = formula.children(node);
    switch (node.form) {
      case Form::negative:
        return walk(builder, formula, links[0].node, scope, !negative);
      case Form::series:
        return series(builder, formula, node, scope, negative);
      case Form::product:
        return product(builder, formula, node, scope, negative);
      case Form::total: {
        std::vector<Link> together;
        for (const Link link : links) {
          if (formula.nodes[link.node].additive) {
            walk(builder, formula, link.node, scope, negative != link.inverse);
          } else {
            together.push_back(link);
          }
        }
        if (!together.empty()) emit(builder, formula, together, scope, negative);
        return;
      }
      default: {  // a definition
        const Formula& definition = names_.definitions[node.id];
        return walk(builder, definition, definition.root, {}, negative);
      }
    }
  }

  /// The factor that holds the sum is split, the others move inside.
  void product(TermBuilder& builder, const Formula& formula, const Syntax& node, const Scope& scope,
               bool negative) {
    const std::size_t outer = factors_.size();
    std::uint32_t summed = 0;
    for (const Link link : formula.children(node)) {
      if (formula.nodes[link.node].additive) {
        summed = link.node;
      } else {
        factors_.push_back({&formula, link.node, link.inverse, scope});
      }
    }
    walk(builder, formula, summed, scope, negative);
    factors_.resize(outer);
  }

  void series(TermBuilder& outer, const Formula& formula, const Syntax& node, const Scope& scope,
              bool negative) {
    const std::size_t depth = outer.depth() + 1;
    std::vector<double> indices = rows_of(outer, formula, node, scope);
    if (indices.empty()) return;
    const std::size_t rows = indices.size() / depth;
    TermBuilder builder(target_.graph, rows, depth, std::move(indices));
    Scope inner = scope;
    inner.push_back({static_cast<int>(depth) - 1, 0});
    walk(builder, formula, formula.children(node)[2].node, inner, negative);
    Term term = builder.finish();
    if (term.arity == 0) {
      plain_.add(target_.graph.mul(target_.graph.constant(static_cast<double>(rows)), term.body), false);
      return;
    }
    if (target_.terms.size() == most_terms)
      fail(formula, node.offset, fmt::format("more than {} sums when definitions are put in", most_terms));
    target_.terms.push_back(std::move(term));
  }

  /// Each row of the outer sums with each value of the index.
  std::vector<double> rows_of(const TermBuilder& outer, const Formula& formula, const Syntax& node,
                              const Scope& scope) {
    const auto links = formula.children(node);
    std::vector<double> rows, at;
    std::vector<double> indices;
    Scope all;  // the outer row, whatever part of it the formula sees
    for (std::size_t column = 0; column < outer.depth(); ++column)
      all.push_back({static_cast<int>(column), 0});
    std::size_t count = 0;
    for (std::size_t row = 0; row < outer.rows(); ++row) {
      outer.read(scope, row, indices);
      const long from =
          binder_.evaluator().integer(formula, links[0].node, indices, "the lower bound of a sum");
      const long to =
          binder_.evaluator().integer(formula, links[1].node, indices, "the upper bound of a sum");
      if (to < from) continue;
      count += static_cast<std::size_t>(to - from + 1);
      if (count > most_rows)
        fail(formula, node.offset, fmt::format("the sum has more than {} terms", most_rows));
      outer.read(all, row, at);
      for (long i = from; i <= to; ++i) {
        rows.insert(rows.end(), at.begin(), at.end());
        rows.push_back(static_cast<double>(i));
      }
    }
    return rows;
  }

  /// Adds ± factors_ · Σ links to the term being built. Where a sum in it has another length in each row, the
  /// rows are written out.
  void emit(TermBuilder& builder, const Formula& formula, std::span<const Link> links, const Scope& scope,
            bool negative) {
    const bool written_out =
        std::ranges::any_of(links, [&](Link link) { return varies(formula, link.node, scope); }) ||
        std::ranges::any_of(factors_, [](const Factor& f) { return varies(*f.formula, f.node, f.scope); });
    if (!written_out) return builder.add(summand(builder, factors_, formula, links, scope), negative);
    const Binder::Unrolling unrolling(binder_);
    for (std::size_t row = 0; row < builder.rows(); ++row) {
      std::vector<Factor> factors = factors_;
      for (Factor& factor : factors) factor.scope = builder.fixed(factor.scope, row);
      plain_.add(summand(plain_, factors, formula, links, builder.fixed(scope, row)), negative);
    }
  }

  NodeId summand(TermBuilder& builder, std::vector<Factor> factors, const Formula& formula,
                 std::span<const Link> links, const Scope& scope) {
    const NodeId one = target_.graph.constant(1);
    if (links.size() > 1 || links[0].inverse)
      return binder_.product(builder, factors, binder_.total(builder, formula, links, scope));
    const Syntax& node = formula.nodes[links[0].node];
    if (node.form == Form::product) {  // its numbers join those of the factors
      for (const Link link : formula.children(node))
        factors.push_back({&formula, link.node, link.inverse, scope});
    } else {
      factors.push_back({&formula, links[0].node, false, scope});
    }
    return binder_.product(builder, factors, one);
  }

  const Names& names_;
  LagrangianGraph& target_;
  Binder binder_;
  TermBuilder plain_;
  std::vector<Factor> factors_;  ///< of all that encloses the node being walked
};

}  // namespace

LagrangianGraph graph_of(Names& names, const std::string& text, const std::string& where) {
  Formula formula = parse(text, where);
  resolve(formula, names);
  LagrangianGraph target;
  Splitter(names, target).split(formula);
  return target;
}

LagrangianGraph equation_of(Names& names, const std::string& text, const std::string& where) {
  Formula formula = parse_equation(text, where);
  resolve(formula, names);
  for (const Syntax& node : formula.nodes)
    if (node.form != Form::number && node.count <= 1u * node.indexed && (node.reads & of_velocities))
      fail(formula, node.offset,
           fmt::format(
               "'{}' stands for velocities; a constraint holds between coordinates, and its derivative "
               "by time follows",
               formula.name(node)));
  if (!(formula.nodes[formula.root].reads & of_coordinates))
    fail(formula, 0, "the constraint depends on no coordinate; leave it out");
  LagrangianGraph target;
  Splitter(names, target).split(formula);
  return target;
}

LagrangianGraph power_of(Names& names, std::span<const ForceText> forces) {
  const int n = names.elements;
  std::string multiplier = "multiplier";
  while (names.find(multiplier)) multiplier += '_';
  names.declare(Coordinate{multiplier, n, n, true}, "force");
  std::vector<Formula> formulas, factors;
  names.indices = {"i"};
  for (const ForceText& force : forces) {  // the multiplier of q[first] belongs to i = index, or to i = 1
    const int before = force.first + 1 - std::max(force.index, 1);
    factors.push_back(parse(fmt::format("{}[i + ({})]", multiplier, before), "force"));
    resolve(factors.back(), names);
  }
  names.table.erase(multiplier);
  for (const ForceText& force : forces) {
    formulas.push_back(parse(force.formula, force.where));
    names.indices.clear();
    resolve_at(formulas.back(), names, force.index);
  }
  LagrangianGraph target;
  Splitter splitter(names, target);
  for (std::size_t k = 0; k < forces.size(); ++k)
    splitter.add_rows(formulas[k], factors[k], std::max(forces[k].index, 1), forces[k].count);
  splitter.finish();
  return target;
}

}  // namespace extremal::formula
