#include "solve/search/monotone_cubic.hpp"

#include <algorithm>
#include <cmath>

#include "solve/guess/first_path.hpp"

namespace extremal {

void MonotoneCubic::fit(const Path& path) {
  n_ = path.coordinates();
  tau_.assign(path.mesh().begin(), path.mesh().end());
  q_.assign(path.nodes().begin(), path.nodes().end());
  slope_.assign(q_.size(), 0);
  const std::size_t last = tau_.size() - 1;
  const auto secant = [&](std::size_t k, std::size_t a) {
    return (q_[(k + 1) * n_ + a] - q_[k * n_ + a]) / (tau_[k + 1] - tau_[k]);
  };
  for (std::size_t a = 0; a < n_; ++a) {
    slope_[a] = secant(0, a);
    slope_[last * n_ + a] = secant(last - 1, a);
    for (std::size_t k = 1; k < last; ++k) {
      const double before = secant(k - 1, a), after = secant(k, a);
      if (!(before * after > 0)) continue;
      const double h = tau_[k] - tau_[k - 1], next = tau_[k + 1] - tau_[k];
      const double share = (h + 2 * next) / (3 * (h + next));
      slope_[k * n_ + a] = before / (share + (1 - share) * before / after);
    }
  }
}

void MonotoneCubic::fill(const ElementTables& tables, Path& path) const {
  const std::size_t last = tau_.size() - 1;
  std::vector<double> ends(q_.begin(), q_.begin() + static_cast<std::ptrdiff_t>(n_));
  ends.insert(ends.end(), q_.end() - static_cast<std::ptrdiff_t>(n_), q_.end());
  std::size_t k = 0;
  fill_path(ends, tables, path, [&](double tau, double* q) {
    if (tau < tau_[k]) k = 0;
    while (k + 1 < last && tau > tau_[k + 1]) ++k;
    const double h = tau_[k + 1] - tau_[k], x = std::clamp((tau - tau_[k]) / h, 0.0, 1.0);
    const double of_end = x * x * (3 - 2 * x), start_slope = x * (1 - x) * (1 - x),
                 end_slope = x * x * (x - 1);
    for (std::size_t a = 0; a < n_; ++a) {
      const std::size_t i = k * n_ + a, j = i + n_;
      q[a] = q_[i] + of_end * (q_[j] - q_[i]) + h * (start_slope * slope_[i] + end_slope * slope_[j]);
    }
  });
}

}  // namespace extremal
