#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace extremal {

/// Largest |x|; not-a-number is passed over.
inline double largest(std::span<const double> x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

/// Largest |x|, or NaN if one is not finite, which the sum remembers and a maximum would not.
inline double largest_if_finite(std::span<const double> x) {
  double part[8] = {}, sum[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= x.size(); i += 8)
    for (int k = 0; k < 8; ++k) {
      const double size = std::abs(x[i + k]);
      part[k] = size > part[k] ? size : part[k];
      sum[k] += size;
    }
  for (; i < x.size(); ++i) {
    part[0] = std::max(part[0], std::abs(x[i]));
    sum[0] += std::abs(x[i]);
  }
  const double total = std::accumulate(sum, sum + 8, 0.0);
  return std::isfinite(total) ? *std::max_element(part, part + 8) : NAN;
}

}  // namespace extremal
