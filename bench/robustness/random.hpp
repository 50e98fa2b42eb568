#pragma once

#include <random>

namespace bench {

/// The same numbers with every standard library.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / static_cast<double>(engine_.max()));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace bench
