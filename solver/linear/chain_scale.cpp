#include "linear/chain_scale.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

void equilibrate(const double* diagonal, const double* lower, int blocks, int n, std::vector<double>& scale) {
  const int sweeps = 3;
  scale.assign(std::size_t(blocks) * n, 1.0);
  std::vector<double> largest;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    largest.assign(scale.size(), 0.0);
    for (int k = 0; k < blocks; ++k)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const std::size_t entry = (std::size_t(k) * n + i) * n + j;
          const int row = k * n + i, column = k * n + j, below = row + n;
          largest[row] = std::max(largest[row], std::abs(diagonal[entry]) * scale[row] * scale[column]);
          if (k + 1 == blocks) continue;
          const double b = std::abs(lower[entry]) * scale[below] * scale[column];
          largest[below] = std::max(largest[below], b);
          largest[column] = std::max(largest[column], b);
        }
    bool changed = false;
    for (std::size_t i = 0; i < scale.size(); ++i)
      if (largest[i] > 0 && (largest[i] < 0.25 || largest[i] >= 4)) {
        scale[i] = std::ldexp(scale[i], -(std::ilogb(largest[i]) / 2));
        changed = true;
      }
    if (!changed) break;
  }
}

}  // namespace extremal
