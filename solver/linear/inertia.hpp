#pragma once

namespace extremal {

/// Signs of the eigenvalues of a symmetric matrix.
struct Inertia {
  int positive = 0, negative = 0, zero = 0;
  bool operator==(const Inertia&) const = default;
};

}  // namespace extremal
