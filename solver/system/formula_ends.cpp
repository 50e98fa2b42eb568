#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "system/copies.hpp"
#include "system/end_condition.hpp"
#include "system/expression_evaluate.hpp"
#include "system/formula_binder.hpp"
#include "system/moved_ends.hpp"

/// \file Conditions between end values, and maps of one end to the other.

namespace extremal {

namespace formula {

namespace {

/// A function of coordinates with its gradient. Its inputs are compact: input k reads number read[k].
struct EndFunction {
  Graph graph;
  NodeId value = 0;
  std::vector<std::uint32_t> read;
  std::vector<NodeId> slopes;
  std::vector<NodeId> curvatures = {};  ///< second derivatives, input by input; empty: not made
};

EndFunction function_of(Formula& formula, Names& names, int index = 0) {
  Scope scope;
  for (const double value : resolve_at(formula, names, index)) scope.push_back({-1, value});
  LagrangianGraph target;
  Binder binder(names, target);
  TermBuilder builder(target.graph);
  builder.add(binder.bind(builder, formula, formula.root, scope), false);
  Term term = builder.finish();
  EndFunction function{std::move(target.graph), term.body, std::move(term.table), {}};
  std::vector<std::uint32_t> inputs(function.read.size());
  for (std::uint32_t k = 0; k < inputs.size(); ++k) inputs[k] = k;
  function.slopes = gradient(function.graph, function.value, inputs);
  return function;
}

bool is_affine(const EndFunction& function) {
  return std::ranges::all_of(function.slopes,
                             [&](NodeId slope) { return function.graph.is_constant(slope); });
}

/// Coefficients and constant of an affine function.
AffineForm coefficients(const EndFunction& function) {
  AffineForm form;
  for (std::size_t k = 0; k < function.read.size(); ++k)
    form.coefficients.push_back(
        {0, static_cast<int>(function.read[k]), function.graph[function.slopes[k]].value});
  const std::vector<double> zero(function.read.size());
  form.constant = evaluate(function.graph, function.value, std::span<const double>(zero));
  return form;
}

/// The values of all nodes at both ends, in one sweep.
std::vector<double> values_of(const EndFunction& function, std::span<const double> start,
                              std::span<const double> end) {
  std::vector<double> values(function.graph.size());
  for (NodeId id = 0; id < values.size(); ++id) {
    const Node& node = function.graph[id];
    if (node.op == Op::constant) {
      values[id] = node.value;
    } else if (node.op == Op::input) {
      const std::uint32_t e = function.read[node.index];
      values[id] = e < start.size() ? start[e] : end[e - start.size()];
    } else {
      values[id] = scalar::apply(node.op, values[node.a], values[node.b]);
    }
  }
  return values;
}

/// g at both ends, its gradient over the 2n end values, and its second derivatives.
double play(const EndFunction& function, std::span<const double> start, std::span<const double> end,
            std::span<double> gradient, std::span<double> hessian = {}) {
  const std::vector<double> values = values_of(function, start, end);
  const std::size_t count = function.read.size(), size = 2 * start.size();
  if (!gradient.empty()) {
    std::ranges::fill(gradient, 0.0);
    for (std::size_t k = 0; k < count; ++k) gradient[function.read[k]] = values[function.slopes[k]];
  }
  if (!hessian.empty()) {
    std::ranges::fill(hessian, 0.0);
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t j = 0; j < count; ++j)
        hessian[function.read[k] * size + function.read[j]] = values[function.curvatures[k * count + j]];
  }
  return values[function.value];
}

void add_curvatures(EndFunction& function) {
  std::vector<std::uint32_t> inputs(function.read.size());
  for (std::uint32_t k = 0; k < inputs.size(); ++k) inputs[k] = k;
  for (const NodeId slope : function.slopes)
    for (const NodeId second : gradient(function.graph, slope, inputs)) function.curvatures.push_back(second);
}

/// An expression of end values, with its derivatives.
EndFunction compact(const Graph& graph, NodeId value) {
  EndFunction function;
  function.read = inputs_of(graph, value);
  std::vector<NodeId> inputs(function.read.empty() ? 0 : function.read.back() + 1);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t k = 0; k < function.read.size(); ++k) {
    inputs[function.read[k]] = function.graph.input(k);
    numbers.push_back(k);
  }
  function.value = copied(graph, value, inputs, function.graph);
  function.slopes = gradient(function.graph, function.value, numbers);
  add_curvatures(function);
  return function;
}

EndCondition condition_of(EndFunction made) {
  return {[function = std::make_shared<const EndFunction>(std::move(made))](
              std::span<const double> start, std::span<const double> end, std::span<double> gradient,
              std::span<double> hessian) { return play(*function, start, end, gradient, hessian); }};
}

}  // namespace

}  // namespace formula

EndEquation end_equation(const std::string& text, const Vocabulary& vocabulary, const std::string& where) {
  using namespace formula;
  Names names = names_of(Kind::condition, vocabulary);
  Formula formula = parse_equation(text, where);
  const auto function = std::make_shared<const EndFunction>(function_of(formula, names));
  if (function->read.empty()) fail(formula, 0, "the equation depends on no end value; write x(0) or x(T)");
  EndEquation equation;
  if ((equation.affine = is_affine(*function))) {
    AffineForm form = coefficients(*function);
    equation.coefficients = std::move(form.coefficients);
    equation.constant = form.constant;
  }
  equation.function = [function](std::span<const double> start, std::span<const double> end,
                                 std::span<double> gradient) {
    return play(*function, start, end, gradient);
  };
  return equation;
}

EndCondition end_condition(const std::string& text, const Vocabulary& vocabulary, const std::string& where) {
  using namespace formula;
  Names names = names_of(Kind::condition, vocabulary);
  Formula formula = parse_equation(text, where);
  EndFunction function = function_of(formula, names);
  if (function.read.empty()) fail(formula, 0, "the equation depends on no end value; write x(0) or x(T)");
  add_curvatures(function);
  return condition_of(std::move(function));
}

EndCondition condition_of_points(const std::string& text, const Vocabulary& vocabulary,
                                 const std::string& where, const MovedEnds& ends) {
  using namespace formula;
  Names names = names_of(Kind::condition, vocabulary);
  Formula formula = parse_equation(text, where);
  const EndFunction function = function_of(formula, names);
  if (function.read.empty()) fail(formula, 0, "the equation depends on no end value; write x(0) or x(T)");
  std::vector<NodeId> points;
  for (const std::uint32_t e : function.read) points.push_back(ends.values[e]);
  Graph graph = ends.graph;
  const NodeId value = copied(function.graph, function.value, points, graph);
  return condition_of(compact(graph, value));
}

EndCondition linear_condition_of_points(std::span<const Triplet> row, double value, const MovedEnds& ends) {
  Graph graph = ends.graph;
  NodeId sum = graph.constant(-value);
  for (const Triplet& entry : row)
    sum = graph.add(sum, graph.mul(graph.constant(entry.value), ends.values[entry.column]));
  return formula::condition_of(formula::compact(graph, sum));
}

AffineForm affine_form(const std::string& text, const Vocabulary& vocabulary, const std::string& where,
                       int index) {
  using namespace formula;
  Names names = names_of(Kind::map, vocabulary);
  Formula formula = parse(text, where);
  const EndFunction function = function_of(formula, names, index);
  if (!is_affine(function))
    fail(formula, 0,
         "a map is affine in the coordinates: sums of coordinates with constant factors, and a constant");
  return coefficients(function);
}

}  // namespace extremal
