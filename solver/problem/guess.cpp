#include <algorithm>
#include <cstddef>

#include "problem/problem.hpp"

namespace extremal {

/// Lagrange's polynomial through the two samples on either side, fewer at the ends of a short guess; the
/// products make it exact at the samples. Constant beyond the first and the last.
void Guess::at(double at, std::span<double> out) const {
  const std::size_t n = out.size(), samples = tau.size();
  const double x = std::clamp(at, tau.front(), tau.back());
  const std::size_t after = std::upper_bound(tau.begin(), tau.end(), x) - tau.begin();
  const std::size_t count = std::min<std::size_t>(4, samples);
  const std::size_t first = std::min(after >= 2 ? after - 2 : 0, samples - count);
  std::fill(out.begin(), out.end(), 0.0);
  for (std::size_t k = first; k < first + count; ++k) {
    double weight = 1;
    for (std::size_t m = first; m < first + count; ++m)
      if (m != k) weight *= (x - tau[m]) / (tau[k] - tau[m]);
    for (std::size_t a = 0; a < n; ++a) out[a] += weight * q[k * n + a];
  }
}

}  // namespace extremal
