#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "system/algebra.hpp"

namespace extremal {

/// ∂f/∂input, where it does not vanish identically.
struct Partial {
  std::uint32_t input;
  Scaled value;
};

/// The partial derivatives of f with respect to the inputs k with wanted[k] (inputs beyond the end are
/// not wanted), by ascending k: reverse accumulation over the nodes of f. f must be built by `algebra`.
std::vector<Partial> differentiate(Algebra& algebra, Scaled f, const std::vector<bool>& wanted);

}  // namespace extremal
