#pragma once

#include <optional>
#include <vector>

#include "problem/closing.hpp"

/// \file Orthogonal maps that rounding leaves exact.

namespace extremal {

/// (P q)_a = sign_a q_{from_a}.
struct SignedPermutation {
  std::vector<int> from;
  std::vector<double> sign;  ///< 1 or −1

  static SignedPermutation identity(int n);
  /// The map q(0) → q(T), if it is one.
  static std::optional<SignedPermutation> of(const ClosingMap& map);

  int size() const { return static_cast<int>(from.size()); }
  void apply(const double* q, double* to) const {
    for (std::size_t a = 0; a < from.size(); ++a) to[a] = sign[a] * q[from[a]];
  }
  SignedPermutation inverse() const;
  bool operator==(const SignedPermutation&) const = default;
};

/// First the right, then the left.
SignedPermutation operator*(const SignedPermutation& left, const SignedPermutation& right);

}  // namespace extremal
