#pragma once

namespace extremal {

/// A sum of two doubles that is not evaluated: what rounding drops of one goes to the other.
struct LongSum {
  double high = 0, low = 0;

  /// 10⁶ small changes lose no more than their own roundoff.
  void add(double change) { low = take(low + change); }
  /// Terms of any size: what they drop gathers beside them.
  void add_term(double x) { low += take(x); }

  /// Adds to high alone, and returns what rounding drops of that.
  double take(double x) {
    const double sum = high + x, part = sum - high;
    const double dropped = (high - (sum - part)) + (x - part);
    high = sum;
    return dropped;
  }
};

}  // namespace extremal
