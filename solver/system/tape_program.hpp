#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "system/kernel.hpp"
#include "system/tape_code.hpp"

namespace extremal {

/// What a kernel is to compute. Direct: nothing else contributes to the row of output, so it is written;
/// otherwise added to.
struct Root {
  Scaled value;
  bool direct;
};

/// A kernel lowered to instructions over the operands (inputs, outputs, slots), in this order.
struct Program {
  std::vector<Instruction> code;
  int inputs = 0, outputs = 0, slots = 0;
  std::vector<Scaled> scalars;  ///< expressions of uniforms, evaluated once for each row
  int operands() const { return inputs + outputs + slots; }
};

Program lower(const Kernel& kernel, std::span<const Root> roots);

}  // namespace extremal
