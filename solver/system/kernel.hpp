#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "system/derivative.hpp"
#include "system/terms.hpp"

namespace extremal {

/// ∂²f/∂row ∂column, row >= column, where it does not vanish identically.
struct SecondPartial {
  std::uint32_t row, column;
  Scaled value;
};

/// A group with its derivatives, as expressions of its inputs.
struct Kernel {
  /// With respect to one active parameter.
  struct Sensitivity {
    std::uint32_t parameter;  ///< its number
    Scaled value;
    std::vector<Partial> gradient;
  };

  Graph graph;
  std::vector<Variable> kinds;
  std::vector<std::uint32_t> table;
  int rows = 1;
  Scaled value;
  std::vector<Partial> gradient;
  std::vector<SecondPartial> hessian;
  std::vector<Sensitivity> sensitivities;

  int inputs() const { return static_cast<int>(kinds.size()); }
  /// Index among its kind of an input in a row.
  std::uint32_t at(int row, std::uint32_t input) const {
    return table[std::size_t(row) * kinds.size() + input];
  }
  bool is_uniform(std::uint32_t input) const {
    return kinds[input] == Variable::uniform || kinds[input] == Variable::parameter;
  }
};

/// Differentiates the sum of the group's parts; at rest, velocities are put to zero first.
Kernel differentiate(const Graph& source, const Group& group, bool at_rest);

/// For each node of the kernel's graph: whether it depends on one of these kinds of input.
std::vector<bool> dependents(const Kernel& kernel, std::initializer_list<Variable> kinds);

/// Numbers for each row of a kernel.
struct RowNumbers {
  int stride = 0;  ///< 0 where all rows have the same
  std::vector<double> values;
  const double* row(int r) const { return values.data() + std::size_t(r) * stride; }
};

/// The values of expressions that depend on uniforms alone.
RowNumbers row_numbers(const Kernel& kernel, std::span<const Scaled> expressions,
                       std::span<const double> uniforms);

}  // namespace extremal
