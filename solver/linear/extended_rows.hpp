#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "linear/extended_kernels.hpp"

/// \file Matrices of numbers with 106 bits, row by row.

namespace extremal {

/// Those of the level in use.
const ExtendedKernels& extended_arithmetic();

/// rows × columns.
class ExtendedRows {
 public:
  /// All zero; keeps memory.
  void reset(std::size_t rows, std::size_t columns) {
    rows_ = rows;
    columns_ = columns;
    high_.assign(rows * columns, 0);
    low_.assign(rows * columns, 0);
  }

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  double* high(std::size_t row) { return high_.data() + row * columns_; }
  double* low(std::size_t row) { return low_.data() + row * columns_; }
  const double* high(std::size_t row) const { return high_.data() + row * columns_; }
  const double* low(std::size_t row) const { return low_.data() + row * columns_; }
  TwoDoubles at(std::size_t row, std::size_t column) const { return {high(row)[column], low(row)[column]}; }
  void set(std::size_t row, std::size_t column, TwoDoubles value) {
    high(row)[column] = value.high;
    low(row)[column] = value.low;
  }
  void add(std::size_t row, std::size_t column, TwoDoubles value) { add_doubles(1, value, one, row, column); }

  /// Entries from (row, column) on += s times as many numbers.
  void add_scaled(std::size_t count, TwoDoubles s, const double* high, const double* low, std::size_t row,
                  std::size_t column = 0) {
    extended_arithmetic().add_scaled(static_cast<long>(count), s, high, low, this->high(row) + column,
                                     this->low(row) + column);
  }
  /// The same of doubles.
  void add_doubles(std::size_t count, TwoDoubles s, const double* x, std::size_t row,
                   std::size_t column = 0) {
    add_scaled(count, s, x, nullptr, row, column);
  }
  void swap(std::size_t a, std::size_t b) {
    std::swap_ranges(high(a), high(a) + columns_, high(b));
    std::swap_ranges(low(a), low(a) + columns_, low(b));
  }

 private:
  static constexpr double one[1] = {1};
  std::size_t rows_ = 0, columns_ = 0;
  std::vector<double> high_, low_;
};

}  // namespace extremal
