#include "system/symbol.hpp"

#include <stdexcept>

#include "system/expression_evaluate.hpp"

namespace extremal {

Symbol record(Op op, const Symbol& a) {
  if (!a.graph()) return scalar::apply(op, a.value(), 0.0);
  return {a.graph(), a.graph()->unary(op, a.node(*a.graph()))};
}

Symbol record(Op op, const Symbol& a, const Symbol& b) {
  Graph* const graph = a.graph() ? a.graph() : b.graph();
  if (!graph) return scalar::apply(op, a.value(), b.value());
  if (a.graph() && b.graph() && a.graph() != b.graph())
    throw std::invalid_argument("an operation on symbols of two different graphs");
  return {graph, graph->binary(op, a.node(*graph), b.node(*graph))};
}

}  // namespace extremal
