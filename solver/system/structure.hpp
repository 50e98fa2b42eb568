#pragma once

#include <vector>

#include "system/kernel.hpp"
#include "system/lagrangian.hpp"

namespace extremal {

/// A Lagrangian taken apart: what is known of it, and kernels whose sum is its remainder.
struct Analysis {
  Structure structure;
  std::vector<Kernel> kernels;
};

/// Throws std::invalid_argument for a malformed Lagrangian.
Analysis analyse(const LagrangianGraph& lagrangian);

/// The index in z = (q, q') of a kernel's coordinate or velocity in a row.
inline int state_index(const Kernel& kernel, int row, std::uint32_t input, int coordinates) {
  const int index = static_cast<int>(kernel.at(row, input));
  return kernel.kinds[input] == Variable::velocity ? coordinates + index : index;
}

/// The entry of the global lower triangle for a kernel's second derivative in a row.
inline HessianEntry hessian_entry(const Kernel& kernel, int row, const SecondPartial& p, int coordinates) {
  const int a = state_index(kernel, row, p.row, coordinates),
            b = state_index(kernel, row, p.column, coordinates);
  return a >= b ? HessianEntry{a, b} : HessianEntry{b, a};
}

}  // namespace extremal
