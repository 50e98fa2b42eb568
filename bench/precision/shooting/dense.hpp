#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

/// \file A small dense system.

namespace bench::shooting {

/// LU factors with row pivoting; row by row.
class Lu {
 public:
  explicit Lu(int size) : n_(size), matrix_(static_cast<std::size_t>(size) * size), pivot_(size) {}
  double& at(int row, int column) { return matrix_[static_cast<std::size_t>(row) * n_ + column]; }

  /// Of the matrix that stands in at(). False if it is singular.
  bool factor() {
    for (int k = 0; k < n_; ++k) {
      int largest = k;
      for (int i = k + 1; i < n_; ++i)
        if (std::abs(at(i, k)) > std::abs(at(largest, k))) largest = i;
      pivot_[k] = largest;
      if (largest != k) std::swap_ranges(&at(k, 0), &at(k, 0) + n_, &at(largest, 0));
      if (!(std::abs(at(k, k)) > 0)) return false;
      const double* const above = &at(k, 0);
      for (int i = k + 1; i < n_; ++i) {
        double* const row = &at(i, 0);
        const double factor = row[k] /= above[k];
        for (int j = k + 1; j < n_; ++j) row[j] -= factor * above[j];
      }
    }
    return true;
  }

  /// x := A⁻¹ x.
  void solve(double* x) {
    for (int k = 0; k < n_; ++k) std::swap(x[k], x[pivot_[k]]);
    for (int i = 1; i < n_; ++i)
      for (int j = 0; j < i; ++j) x[i] -= at(i, j) * x[j];
    for (int i = n_ - 1; i >= 0; --i) {
      for (int j = i + 1; j < n_; ++j) x[i] -= at(i, j) * x[j];
      x[i] /= at(i, i);
    }
  }

 private:
  int n_;
  std::vector<double> matrix_;
  std::vector<int> pivot_;
};

}  // namespace bench::shooting
