#include "motion/extrapolation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace extremal {

namespace {

constexpr int most_columns = 12, deepest = 12;

}  // namespace

Extrapolation::Extrapolation(RightHandSide<dd_real> right_hand_side, int size)
    : slope_(std::move(right_hand_side)),
      size_(size),
      table_(static_cast<std::size_t>(most_columns) * size),
      before_(size),
      slopes_(size) {}

bool Extrapolation::advance(dd_real t, std::span<dd_real> y, dd_real h, double tolerance, int depth) {
  for (int column = 0; column < most_columns; ++column) {
    if (!midpoint(t, y, h, 2 * (column + 1), row(column))) break;
    if (extrapolate(column) <= tolerance) {
      std::ranges::copy(row(0), y.begin());
      return true;
    }
  }
  if (depth == deepest) return false;
  h /= 2.0;
  return advance(t, y, h, tolerance, depth + 1) && advance(t + h, y, h, tolerance, depth + 1);
}

bool Extrapolation::midpoint(dd_real t, std::span<const dd_real> y, dd_real h, int count,
                             std::span<dd_real> end) {
  const dd_real part = h / double(count);
  std::ranges::copy(y, before_.begin());
  if (!slope_(t, y, slopes_)) return false;
  for (int m = 0; m < size_; ++m) end[m] = y[m] + part * slopes_[m];
  for (int k = 1; k < count; ++k) {
    if (!slope_(t + part * double(k), end, slopes_)) return false;
    for (int m = 0; m < size_; ++m) {
      before_[m] += 2.0 * part * slopes_[m];
      std::swap(before_[m], end[m]);
    }
  }
  return std::ranges::all_of(end, [](const dd_real& x) { return std::isfinite(to_double(x)); });
}

/// Neville's scheme upwards from the last row: the first becomes the best value. By how much it was changed
/// last, relative.
double Extrapolation::extrapolate(int column) {
  double change = 0, largest = 0;
  for (int k = column - 1; k >= 0; --k) {
    // 1/((n_j/n_k)² − 1), n the numbers of substeps
    const double high = (column + 1.0) * (column + 1), low = (k + 1.0) * (k + 1);
    for (int m = 0; m < size_; ++m) {
      const dd_real by = (row(k + 1)[m] - row(k)[m]) * low / (high - low);
      row(k)[m] = row(k + 1)[m] + by;
      if (k > 0) continue;
      change = std::max(change, std::abs(to_double(by)));
      largest = std::max(largest, std::abs(to_double(row(k)[m])));
    }
  }
  return column > 0 && largest > 0 ? change / largest : 1;
}

}  // namespace extremal
