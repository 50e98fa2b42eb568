#pragma once

namespace extremal {

/// Between what is below a place and what is not; `low` may be the larger number.
struct Bisected {
  double low, high;
  double middle() const { return 0.5 * (low + high); }
};

/// Halves an interval so often. below(x) holds at `low` and not at `high`, of which neither is asked for.
template <class Below>
Bisected bisect(double low, double high, int halvings, const Below& below) {
  Bisected at{low, high};
  for (int k = 0; k < halvings; ++k) {
    const double x = at.middle();
    (below(x) ? at.low : at.high) = x;
  }
  return at;
}

}  // namespace extremal
