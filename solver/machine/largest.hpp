#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace extremal {

/// Largest |x|; not-a-number is passed over.
inline double largest(std::span<const double> x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace extremal
