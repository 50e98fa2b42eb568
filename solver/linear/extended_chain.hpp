#pragma once

#include <vector>

#include "linear/extended_rows.hpp"
#include "linear/inertia.hpp"

/// \file The block-tridiagonal matrix of the nodes with 106 bits, for paths along which factors of double
/// precision lose all digits.

namespace extremal {

/// A = tridiag(Bᵀ, D, B) as in chain.hpp. Rows of two neighbouring blocks exchange places, so that the growth
/// is that of Gaussian elimination with partial pivoting.
class ExtendedChain {
 public:
  /// Sets the shape, and all blocks to zero; keeps memory.
  void reset(int blocks, int size);

  int blocks() const { return blocks_; }
  int size() const { return size_; }
  std::size_t order() const { return static_cast<std::size_t>(blocks_) * size_; }
  ExtendedRows& diagonal() { return diagonal_; }  ///< order × n: both triangles of the blocks
  ExtendedRows& lower() { return lower_; }        ///< row k n + i: row i of the block below diagonal block k
  const ExtendedRows& diagonal() const { return diagonal_; }
  const ExtendedRows& lower() const { return lower_; }

  /// False if a pivot is zero or not finite.
  bool factor();
  /// X := A⁻¹ X, as many rows as order().
  void solve(ExtendedRows& x) const;

  /// Signs of the pivots of LDLᵀ without exchanges. A pivot that vanishes counts as null.
  Inertia inertia() const;

 private:
  void load(int k);
  int pivot_row(int p, int rows) const;

  int blocks_ = 0, size_ = 0;
  ExtendedRows diagonal_, lower_;
  ExtendedRows panel_;                ///< 2n × 3n: rows that are left of one block, and those of the next
  ExtendedRows upper_, multipliers_;  ///< order × 3n and order × 2n
  std::vector<int> exchanged_;        ///< with row p of the panel
};

}  // namespace extremal
