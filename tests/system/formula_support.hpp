#pragma once

#include <string>
#include <vector>

#include "system/expression.hpp"
#include "system/formula.hpp"
#include "system/formula_graph.hpp"

namespace extremal {

inline LagrangianGraph graph_of(const SystemText& text) {
  formula::Names names = formula::names_of(text);
  return formula::graph_of(names, text.lagrangian, "lagrangian");
}

/// L at a point, term by term and row by row.
inline double value_of(const LagrangianGraph& l, const std::vector<double>& q, const std::vector<double>& v,
                       double t) {
  std::vector<double> inputs(q);
  inputs.insert(inputs.end(), v.begin(), v.end());
  inputs.push_back(t);
  inputs.insert(inputs.end(), l.uniforms.begin(), l.uniforms.end());
  double sum = 0;
  for (const Term& term : l.terms)
    for (int row = 0; row < term.rows(); ++row) {
      std::vector<double> local;
      for (int m = 0; m < term.arity; ++m) local.push_back(inputs.at(term.table.at(row * term.arity + m)));
      sum += evaluate(l.graph, term.body, std::span<const double>(local));
    }
  return sum;
}

inline double value_of(const SystemText& text, const std::vector<double>& q, const std::vector<double>& v,
                       double t = 0) {
  return value_of(graph_of(text), q, v, t);
}

/// "message | where | offset" of the FormulaError that is thrown, else "no error".
template <class Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const FormulaError& error) {
    return std::string(error.what()) + " | " + error.where + " | " + std::to_string(error.offset);
  }
  return "no error";
}

inline std::string error_of(const SystemText& text) {
  return error_of([&] { graph_of(text); });
}

}  // namespace extremal
