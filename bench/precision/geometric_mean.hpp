#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

/// \file The mean of ratios of times.

namespace bench {

class GeometricMean {
 public:
  /// Another's time over ours, where both are known.
  void add(std::optional<double> other, std::optional<double> ours) {
    if (!other || !ours) return;
    sum_ += std::log(*other / *ours), ++count_, below_ += *other < *ours;
  }
  std::string text() const {
    if (count_ == 0) return "none";
    return fmt::format("{:.2f} over {} cells, below 1 in {}", std::exp(sum_ / count_), count_, below_);
  }

 private:
  double sum_ = 0;
  int count_ = 0, below_ = 0;
};

}  // namespace bench
