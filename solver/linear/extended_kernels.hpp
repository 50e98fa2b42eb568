#pragma once

#include "machine/simd.hpp"

/// \file Loops over numbers with 106 bits, each the unevaluated sum of two doubles (Dekker, Numer. Math. 18
/// (1971) 224), in an array of high and one of low parts.

namespace extremal {

/// A number by its two parts, |low| at most half a unit in the last place of high.
struct TwoDoubles {
  double high = 0, low = 0;
};

struct ExtendedKernels {
  /// y += s x, `count` numbers each; x_low may be null, where it is zero.
  void (*add_scaled)(long count, TwoDoubles s, const double* x_high, const double* x_low, double* y_high,
                     double* y_low);
  TwoDoubles (*multiply)(TwoDoubles a, TwoDoubles b);
  TwoDoubles (*divide)(TwoDoubles a, TwoDoubles b);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(ExtendedKernels extended_kernels())

}  // namespace extremal
