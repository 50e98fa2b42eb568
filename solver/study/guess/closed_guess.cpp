#include "study/guess/closed_guess.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::VectorXd;

/// Parts of T: samples that are nearer to an end stand for it.
constexpr double same_time = 1e-9;

}  // namespace

ClosedGuess::ClosedGuess(const Problem& problem)
    : n_(problem.coordinates()), guess_(problem.guess), map_(closing_map(problem)), start_(n_), end_(n_) {
  guess_.at(0, {start_.data(), static_cast<std::size_t>(n_)});
  guess_.at(1, {end_.data(), static_cast<std::size_t>(n_)});
}

void ClosedGuess::at(double tau, std::span<double> q) const {
  const double periods = std::floor(tau);
  guess_.at(tau - periods, q);
  Eigen::Map<VectorXd> x(q.data(), n_);
  const bool turned = !map_.r.isIdentity(0);
  for (double k = 0; k < periods; ++k) {
    x -= start_;
    if (turned) x = (map_.r * x).eval();
    x += end_;
  }
  for (double k = 0; k > periods; --k) {
    x -= end_;
    if (turned) x = solved(map_.r, x);
    x += start_;
  }
}

Guess ClosedGuess::from(double tau) const {
  Guess moved;
  moved.tau = {0, 1};
  for (const double sample : guess_.tau) {
    const double later = sample - tau - std::floor(sample - tau);
    if (sample < 1 && later > same_time && later < 1 - same_time) moved.tau.push_back(later);
  }
  std::ranges::sort(moved.tau);
  moved.q.resize(moved.tau.size() * static_cast<std::size_t>(n_));
  for (std::size_t k = 0; k < moved.tau.size(); ++k)
    at(tau + moved.tau[k], {moved.q.data() + k * n_, static_cast<std::size_t>(n_)});
  return moved;
}

}  // namespace extremal
