#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

/// \file Random numbers that are the same everywhere.

namespace bench {

/// SplitMix64: G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, OOPSLA
/// 2014.
class Random {
 public:
  /// A stream of its own for each pair.
  Random(std::uint64_t seed, std::uint64_t index) : state_(seed) {
    state_ = next() ^ index;
    state_ = next();
  }

  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// 0 < low ≤ high.
  double log_uniform(double low, double high) { return low * std::pow(high / low, unit()); }
  bool chance(double probability) { return unit() < probability; }
  /// Among 0 … count − 1.
  std::size_t below(std::size_t count) { return next() % count; }
  /// Both ends included.
  int between(int low, int high) { return low + static_cast<int>(below(high - low + 1)); }
  template <class List>
  const auto& pick(const List& list) {
    return list[below(list.size())];
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace bench
