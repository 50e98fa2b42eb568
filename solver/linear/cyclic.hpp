#pragma once

#include <vector>

#include "linear/border.hpp"

/// \file A block-tridiagonal matrix whose last block is coupled to the first.

namespace extremal {

/// Blocks D_k = diagonal(k), symmetric, both triangles; lower(k) couples row block k+1 with column block k,
/// the last one row block 0 with column block N−1. Beside it a symmetric border of m columns (phase
/// conditions). Solved as a bordered chain: the last block joins the border. With N = 2 both couplings
/// stand in one place and add up, with N = 1 the coupling and its transpose add to the block.
class Cyclic {
 public:
  /// Sets the shape; keeps memory. Throws std::invalid_argument for fewer than 1 block, a size below 1 or
  /// a negative border.
  void resize(int blocks, int size, int border = 0);

  int blocks() const { return blocks_; }
  int size() const { return size_; }
  int order() const { return blocks_ * size_ + border_; }

  double* diagonal(int k) { return k + 1 < blocks_ ? chain_.diagonal(k) : ends_.data(); }
  double* lower(int k) {
    return k + 2 < blocks_ ? chain_.lower(k) : ends_.data() + (k + 2 - blocks_ + 1) * size_ * size_;
  }
  double* column_block() { return columns_.data(); }  ///< (N n) × m, row-major
  double* corner() { return corner_.data(); }         ///< m × m, row-major

  /// False if the matrix is singular to working precision or not finite.
  bool factor();

  /// X := K⁻¹ X for all order() rows, row-major with `columns` columns; see Border::solve().
  void solve(double* x, int columns) const { arrow_.solve(chain_, x, columns); }

  /// See Border::solve_least_norm() and Border::inertia().
  int solve_least_norm(double* x, int columns, double threshold) const {
    return arrow_.solve_least_norm(chain_, x, columns, threshold);
  }
  Inertia inertia(double threshold = 0) const { return arrow_.inertia(threshold); }
  const Border& arrow() const { return arrow_; }

 private:
  int blocks_ = 0, size_ = 0, border_ = 0;
  Chain chain_;  // blocks 0 … N−2
  Border arrow_;
  std::vector<double> ends_;  // D_{N−1}, B_{N−2}, B_{N−1}
  std::vector<double> columns_, corner_;
};

}  // namespace extremal
