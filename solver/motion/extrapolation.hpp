#pragma once

#include <qd/dd_real.h>

#include <span>
#include <vector>

#include "motion/dop853.hpp"

/// \file Integration of ordinary differential equations in twice the precision.

namespace extremal {

/// Gragg, Bulirsch and Stoer: the explicit midpoint rule with 2, 4, 6, … substeps, extrapolated in the square
/// of their length (E. Hairer, S.P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd
/// edition, II.9).
class Extrapolation {
 public:
  Extrapolation(RightHandSide<dd_real> right_hand_side, int size);

  /// Takes y from t to t + h; in halves, and those likewise, where the last extrapolation changes y by more
  /// than `tolerance` of its largest component. False where the right-hand side cannot be evaluated, or no
  /// halving suffices; y is then somewhere on the way.
  bool advance(dd_real t, std::span<dd_real> y, dd_real h, double tolerance) {
    return advance(t, y, h, tolerance, 0);
  }

 private:
  bool advance(dd_real t, std::span<dd_real> y, dd_real h, double tolerance, int depth);
  std::span<dd_real> row(int k) { return std::span(table_).subspan(std::size_t(k) * size_, size_); }
  bool midpoint(dd_real t, std::span<const dd_real> y, dd_real h, int count, std::span<dd_real> end);
  double extrapolate(int column);

  RightHandSide<dd_real> slope_;
  int size_;
  std::vector<dd_real> table_, before_, slopes_;
};

}  // namespace extremal
