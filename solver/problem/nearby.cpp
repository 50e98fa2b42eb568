#include "problem/nearby.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

NearbyPoints::NearbyPoints(const Problem& problem) : problem_(problem), n_(problem.coordinates()) {
  scale_.assign(n_, 0);
  for (std::size_t k = 0; k < problem.guess.q.size(); ++k)
    scale_[k % n_] = std::max(scale_[k % n_], std::abs(problem.guess.q[k]));
  for (std::size_t e = 0; e < problem.ends.offset.size(); ++e)
    scale_[e % n_] = std::max(scale_[e % n_], std::abs(problem.ends.offset[e]));
  for (double& s : scale_)
    if (s == 0) s = 1;
}

double NearbyPoints::next(std::vector<double>& q, std::vector<double>& v) {
  const double tau = 0.5 + 0.5 * uniform();
  q.assign(n_, 0);
  v.assign(n_, 0);
  if (problem_.guess.given()) {
    problem_.guess.at(tau, q);
  } else {
    const std::vector<double>& ends = problem_.ends.offset;
    for (int a = 0; a < n_; ++a) q[a] = (1 - tau) * ends[a] + tau * ends[n_ + a];
  }
  for (int a = 0; a < n_; ++a) {
    q[a] += 0.2 * scale_[a] * uniform();
    v[a] = scale_[a] * uniform();
  }
  return tau * problem_.duration.value;
}

double NearbyPoints::uniform() { return 2 * (double(random_() >> 11) + 0.5) / double(1ull << 53) - 1; }

}  // namespace extremal
