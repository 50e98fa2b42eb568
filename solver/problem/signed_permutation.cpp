#include "problem/signed_permutation.hpp"

#include <cmath>
#include <numeric>

namespace extremal {

SignedPermutation SignedPermutation::identity(int n) {
  SignedPermutation result{std::vector<int>(n), std::vector<double>(n, 1)};
  std::iota(result.from.begin(), result.from.end(), 0);
  return result;
}

std::optional<SignedPermutation> SignedPermutation::of(const ClosingMap& map) {
  const auto n = static_cast<int>(map.r.rows());
  if (!map.c.isZero(0) || !(map.r * map.r.transpose()).isIdentity(0)) return std::nullopt;
  SignedPermutation result = identity(n);
  for (int a = 0; a < n; ++a) {
    Eigen::Index from = 0;
    if (map.r.row(a).cwiseAbs().maxCoeff(&from) != 1) return std::nullopt;
    result.from[a] = static_cast<int>(from);
    result.sign[a] = map.r(a, from);
  }
  return result;
}

SignedPermutation SignedPermutation::inverse() const {
  SignedPermutation result = *this;
  for (int a = 0; a < size(); ++a) {
    result.from[from[a]] = a;
    result.sign[from[a]] = sign[a];
  }
  return result;
}

SignedPermutation operator*(const SignedPermutation& left, const SignedPermutation& right) {
  SignedPermutation result = left;
  for (int a = 0; a < left.size(); ++a) {
    result.from[a] = right.from[left.from[a]];
    result.sign[a] = left.sign[a] * right.sign[left.from[a]];
  }
  return result;
}

}  // namespace extremal
