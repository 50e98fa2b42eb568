#pragma once

#include <algorithm>
#include <cmath>

/// \file Lengths of the steps of DOP853.

namespace extremal::dop853 {

inline constexpr double safety = 0.9;
inline constexpr double most_growth = 6, most_shrinking = 1.0 / 3;
/// Shortening where the right-hand side cannot be evaluated.
inline constexpr double retreat = 0.25;
/// Of the time ahead, for the first step, at least; and the part of its own size by which a block may change
/// in it.
inline constexpr double shortest_start = 1e-6, first_change = 0.01;

/// Hairer, Nørsett and Wanner (10.17): |h| e5² / √(e5² + 0.01 e3²), in units of the tolerance, from the sums
/// of squares of `size` components.
template <class T>
T error_norm(T sum5, T sum3, T h, int size) {
  return sum5 == 0 ? 0 : std::abs(h) * sum5 / std::sqrt((sum5 + T(0.01) * sum3) * size);
}

/// Of a step of that error, in units of the tolerance.
template <class T>
T growth(T error) {
  const T best = error > 0 ? T(safety) * std::pow(error, T(-1) / 8) : T(most_growth);
  return std::clamp<T>(best, most_shrinking, most_growth);
}

}  // namespace extremal::dop853
