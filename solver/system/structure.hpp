#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "system/kernel.hpp"
#include "system/lagrangian.hpp"

namespace extremal {

/// The numbers of a structure, M, C, a and the frequencies, as expressions of the uniforms.
class StructureNumbers {
 public:
  /// Puts their values into the structure. False where not all are finite; then M, C and a are empty.
  bool put(std::span<const double> uniforms, Structure& s) const;

  /// Adds second derivatives with a velocity. False, and nothing is added, if one is not constant.
  bool add_second(const std::shared_ptr<const Kernel>& kernel);
  /// Adds a = ∂L/∂q' where q = q' = 0. False, and nothing is added, if it is not constant or a momentum
  /// jumps: then second derivatives do not tell the first ones.
  bool add_first(const Kernel& kernel);
  /// Adds the frequencies of sin, cos and tan. Returns whether t stands in them alone.
  bool add_frequencies(const Kernel& kernel);
  /// Leaves the frequencies alone.
  void clear_form() { second_.clear(), first_.clear(); }

 private:
  /// Expressions in the rows of a kernel.
  struct Expressions {
    std::shared_ptr<const Kernel> kernel;
    std::vector<Scaled> values;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> inputs;  ///< that each is a derivative by
  };
  std::vector<Expressions> second_, first_, frequencies_;
};

/// A Lagrangian taken apart: what is known of it, and kernels whose sum is its remainder.
struct Analysis {
  Structure structure;
  StructureNumbers numbers;
  std::vector<std::shared_ptr<const Kernel>> kernels;
};

/// Whether t, q or q' stand so that forces may act in pulses whose tails fall faster than any power: in tanh,
/// in exp of what is not linear, in high powers of sin and the like, or in reciprocals of exp, sinh or cosh.
/// (Elements see tails that fall like powers.)
bool pulses(const Kernel& kernel, NodeId value);

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
