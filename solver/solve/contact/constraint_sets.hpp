#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

/// \file Sets of inequalities, by ascending numbers.

namespace extremal {

inline std::vector<int> sorted_union(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> both;
  std::ranges::set_union(a, b, std::back_inserter(both));
  return both;
}

inline std::vector<int> sorted_difference(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> only;
  std::ranges::set_difference(a, b, std::back_inserter(only));
  return only;
}

}  // namespace extremal
