#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace extremal {

/// Disjoint sets of the numbers 0 … count − 1, each alone at first.
class MergedSets {
 public:
  explicit MergedSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// A number that stands for the set of k.
  std::uint32_t find(std::uint32_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }

  void merge(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace extremal
