#pragma once

namespace extremal {

/// Distance from 1 to the next double.
inline constexpr double machine_epsilon = 0x1p-52;

/// Signs of the eigenvalues of a symmetric matrix.
struct Inertia {
  int positive = 0, negative = 0, zero = 0;
  bool operator==(const Inertia&) const = default;
};

}  // namespace extremal
