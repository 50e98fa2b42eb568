#pragma once

#include <cstdint>
#include <vector>

#include "system/tape.hpp"

/// \file The terms of a Lagrangian, sorted into groups of rows that one kernel serves.

namespace extremal {

/// What an input of a kernel stands for. A parameter is an active uniform that derivatives are asked for; the
/// same for all rows.
enum class Variable : std::uint8_t { coordinate, velocity, time, parameter, uniform };

/// What a body's input is bound to: a number or an input of the group. What is not read is 0.
struct Binding {
  bool number = true;
  double value = 0;
  std::uint32_t input = 0;
};

/// A body of the Lagrangian's graph with its inputs bound.
struct Part {
  NodeId body = 0;
  std::vector<Binding> inputs;
};

/// Σ_rows Σ_parts body. In one row, no two inputs stand for the same variable.
struct Group {
  std::vector<Part> parts;
  std::vector<Variable> kinds;       ///< of the inputs
  std::vector<std::uint32_t> table;  ///< rows × inputs: index among its kind
  int rows = 1;
};

/// Rows of a term that differ in which inputs coincide go to different groups. Uniforms that do not vary
/// between the rows of a group become numbers, but for those that other values may be put in for. All that
/// stands in a few rows is collected in one group of one row, so that it shares subexpressions. Throws
/// std::invalid_argument for a malformed table.
std::vector<Group> group_terms(const LagrangianGraph& lagrangian);

}  // namespace extremal
