#pragma once

#include <vector>

#include "linear/sparse_pattern.hpp"

namespace extremal {

/// The structure of the factor of a sparse symmetric matrix: positions in the order of elimination, divided
/// into runs that are eliminated together, the supernodes, parents after children.
struct Supernodes {
  std::vector<int> order;      ///< which unknown stands at each position
  std::vector<int> first;      ///< first position of each, and the end
  std::vector<int> row_begin;  ///< of each, in `row`, and the end
  std::vector<int> row;        ///< later positions that are coupled with the supernode's, ascending
  std::vector<int> parent;     ///< that which takes over what is left in those rows, or −1

  int count() const { return int(first.size()) - 1; }
};

/// Ordered by AMD. Supernodes have at most `most` positions; small ones are merged although entries are then
/// kept that are zero. Throws std::bad_alloc without memory.
Supernodes find_supernodes(const SparsePattern& lower, int most);

}  // namespace extremal
