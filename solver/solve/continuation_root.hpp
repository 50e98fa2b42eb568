#pragma once

#include <cmath>
#include <utility>

#include "solve/continuation.hpp"

/// \file Places on a step where a test is zero.

namespace extremal {

/// What is met on a step is located to this, relative to the distance wanted.
inline constexpr double located = 1e-11;

/// Where along the tangent test(), read at the place, is zero: the secant through ends of the interval, one
/// of which is weighted less when it stays (Illinois). To where done(value, last change) holds. NaN where the
/// branch cannot be followed.
template <class Test, class Done>
double Continuation::root(const Stand& from, double low, double at_low, double high, double at_high,
                          const Test& test, const Done& done) {
  constexpr int most_trials = 60;
  double last = low;
  for (int k = 0; k < most_trials; ++k) {
    const double at = (low * at_high - high * at_low) / (at_high - at_low);
    if (!go(from, at)) return NAN;
    const double value = test();
    if (done(value, at - last) || at == last) return at;
    last = at;
    if (value * at_high < 0) {
      low = std::exchange(high, at);
      at_low = std::exchange(at_high, value);
    } else {
      high = at;
      at_high = value;
      at_low *= 0.5;
    }
  }
  return NAN;
}

}  // namespace extremal
