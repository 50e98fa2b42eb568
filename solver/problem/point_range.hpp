#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace extremal {

/// The largest range of a coordinate over points that are listed row by row; 0 without points.
inline double largest_range(std::span<const double> points, std::size_t coordinates) {
  double most = 0;
  for (std::size_t a = 0; a < coordinates; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t k = a; k < points.size(); k += coordinates) {
      low = std::min(low, points[k]);
      high = std::max(high, points[k]);
    }
    most = std::max(most, high - low);
  }
  return most;
}

}  // namespace extremal
