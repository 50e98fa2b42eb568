#pragma once

#include <utility>
#include <vector>

#include "system/algebra.hpp"

/// \file Linear algebra whose numbers are expressions.

namespace extremal::expression_matrix {

using Row = std::vector<Scaled>;
using Matrix = std::vector<Row>;

/// A = L U without pivoting, on an expression graph.
class Factors {
 public:
  Factors(Algebra& algebra, Matrix a) : algebra_(algebra), a_(std::move(a)) {
    for (int k = 0; k < size(); ++k) {
      inverse_.push_back(algebra_.reciprocal(a_[k][k]));
      for (int i = k + 1; i < size(); ++i) {
        if (a_[i][k].zero()) continue;
        a_[i][k] = algebra_.multiply(a_[i][k], inverse_[k]);
        for (int j = k + 1; j < size(); ++j) take(a_[i][j], a_[i][k], a_[k][j]);
      }
    }
  }

  Scaled pivot(int k) const { return a_[k][k]; }

  Row solve(Row r) {
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j < i; ++j) take(r[i], a_[i][j], r[j]);
    for (int i = size(); i-- > 0;) {
      for (int j = i + 1; j < size(); ++j) take(r[i], a_[i][j], r[j]);
      r[i] = algebra_.multiply(r[i], inverse_[i]);
    }
    return r;
  }

  Row solve_transposed(Row r) {
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < i; ++j) take(r[i], a_[j][i], r[j]);
      r[i] = algebra_.multiply(r[i], inverse_[i]);
    }
    for (int i = size(); i-- > 0;)
      for (int j = i + 1; j < size(); ++j) take(r[i], a_[j][i], r[j]);
    return r;
  }

 private:
  int size() const { return static_cast<int>(a_.size()); }
  /// x − a b.
  void take(Scaled& x, Scaled a, Scaled b) {
    if (!a.zero() && !b.zero()) x = algebra_.subtract(x, algebra_.multiply(a, b));
  }

  Algebra& algebra_;
  Matrix a_;
  Row inverse_;
};

inline void add_product(Algebra& algebra, Scaled& sum, Scaled a, Scaled b) {
  if (!a.zero() && !b.zero()) sum = algebra.add(sum, algebra.multiply(a, b));
}

inline Row negative(Row r) {
  for (Scaled& x : r) x = -x;
  return r;
}

}  // namespace extremal::expression_matrix
