#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "system/expression.hpp"
#include "system/lagrangian.hpp"
#include "system/symbol.hpp"

/// \file From expression graphs to a Lagrangian that is played as a tape.

namespace extremal {

/// One summand of L: Σ_rows body(local inputs). A plain summand is one row. Local input m of row r reads
/// the global input table[r*arity + m]; global inputs are numbered
///   a            coordinate q_a,       a < n
///   n + a        velocity q'_a
///   2n           time
///   2n + 1 + k   uniforms[k], a number that is the same at all points (active parameters first).
struct Term {
  NodeId body = 0;
  int arity = 0;
  std::vector<std::uint32_t> table;
  int rows() const { return arity ? static_cast<int>(table.size()) / arity : 1; }
};

/// L as a sum of terms over one graph.
struct LagrangianGraph {
  int coordinates = 0;
  Graph graph;
  std::vector<Term> terms;
  std::vector<double> uniforms;
  int parameters = 0;        ///< active ones: the first uniforms
  bool replaceable = false;  ///< active ones are there for Lagrangian::with(), not for derivatives
  bool first_order = false;  ///< of a system in phase space, see phase_space.hpp
};

/// Reads off the structure, differentiates, compiles. The result is a TapeLagrangian.
std::shared_ptr<const Lagrangian> make_lagrangian(LagrangianGraph graph);

/// Traces functor(q, v, t) once, with q and v spans of Symbol:
///   auto kepler = trace(2, [](auto q, auto v, auto t) {
///     return (v[0]*v[0] + v[1]*v[1])/2 + 1/sqrt(q[0]*q[0] + q[1]*q[1]); });
template <class Functor>
LagrangianGraph trace_graph(int coordinates, Functor&& functor) {
  LagrangianGraph l;
  l.coordinates = coordinates;
  std::vector<Symbol> z;
  std::vector<std::uint32_t> table;
  for (std::uint32_t k = 0; k <= 2u * coordinates; ++k) {
    z.emplace_back(&l.graph, l.graph.input(k));
    table.push_back(k);
  }
  const Symbol value = functor(std::span<const Symbol>(z.data(), coordinates),
                               std::span<const Symbol>(z.data() + coordinates, coordinates), z.back());
  l.terms.push_back({value.node(l.graph), 2 * coordinates + 1, std::move(table)});
  return l;
}

/// Traces and compiles.
template <class Functor>
std::shared_ptr<const Lagrangian> trace(int coordinates, Functor&& functor) {
  return make_lagrangian(trace_graph(coordinates, functor));
}

}  // namespace extremal
