#pragma once

#include <span>
#include <vector>

#include "action/path.hpp"

/// \file How well a path's elements resolve it, read off their Legendre coefficients.

namespace extremal {

/// Sizes of a path: largest range of a coordinate and of a velocity, largest |q|.
struct Scales {
  double q = 0;  ///< the range, or the magnitude where that is negligible
  double v = 0, magnitude = 0, range = 0;
  double slowest = 0;  ///< v is taken to be no smaller
};
Scales scales(const Path& path, const ElementTables& tables);

/// Coefficients of P_k fall like ρ^−k where q is analytic about an element. The sizes of the last two and of
/// the two before give each element's rate; the error of q is the first coefficient left out, those
/// of q' and q'' its derivatives at the end of the element, k(k + 1)/h and (k − 1)k(k + 1)(k + 2)/2h².
class Resolution {
 public:
  void measure(const Path& path, const ElementTables& tables);

  /// Of the coefficients of one element.
  struct Tail {
    double size, fall, h;  ///< of coefficient s; factor from one to the next; element length
  };
  int degree() const { return degree_; }
  std::span<const Tail> tails() const { return tails_; }

  /// Of q, of q' and of q''.
  struct Error {
    double q = 0, v = 0, a = 0;
  };
  /// Expected truncation error with elements of `degree`, worst over elements and coordinates.
  Error at(int degree) const;

  /// The least degree from the present one on whose expected error is allowed; above `highest` if none is.
  int degree_for(const Error& allowed, int highest) const;

 private:
  int degree_ = 0;
  std::vector<Tail> tails_;
  std::vector<double> coefficients_;  ///< the last four of every coordinate over a batch
};

}  // namespace extremal
