#include "rivals/guessed_path.hpp"

#include <algorithm>

#include "linear/dense.hpp"

namespace extremal {

namespace {

/// Part of the duration over which the velocity of a guess is read.
constexpr double piece = 1e-5;

/// Ends that meet the relation, nearest to the guess, or to a constant or a line where there is none.
Eigen::VectorXd guessed_ends(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  const auto& fixed = problem.ends.fixed;
  Eigen::VectorXd offset = Eigen::Map<const Eigen::VectorXd>(problem.ends.offset.data(), 2 * n);
  if (problem.ends.free == 0) return offset;
  Eigen::VectorXd target = Eigen::VectorXd::Zero(2 * n);
  if (problem.guess.given()) {
    problem.guess.at(0, {target.data(), n});
    problem.guess.at(1, {target.data() + n, n});
  } else {
    for (std::size_t a = 0; a < n; ++a) {
      if (fixed[a]) target[n + a] = offset[a];
      if (fixed[n + a]) target[a] = offset[n + a];
    }
  }
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(2 * n, problem.ends.free);
  for (const Triplet& e : problem.ends.z) z(e.row, e.column) += e.value;
  return offset + z * least_norm(z, target - offset);
}

}  // namespace

GuessedPath::GuessedPath(const Problem& problem)
    : problem_(problem), n_(problem.coordinates()), shift_(guessed_ends(problem)) {
  if (!problem.guess.given()) return;
  const auto n = static_cast<std::size_t>(n_);
  Eigen::VectorXd ends(2 * n_);
  problem.guess.at(0, {ends.data(), n});
  problem.guess.at(1, {ends.data() + n, n});
  shift_ -= ends;
}

Eigen::VectorXd GuessedPath::at(double tau) const {
  Eigen::VectorXd q = (1 - tau) * shift_.head(n_) + tau * shift_.tail(n_);
  if (!problem_.guess.given()) return q;
  Eigen::VectorXd given(n_);
  problem_.guess.at(tau, {given.data(), static_cast<std::size_t>(n_)});
  return q + given;
}

Eigen::VectorXd GuessedPath::slope(double tau) const {
  const double from = std::max(0.0, tau - piece), to = std::min(1.0, tau + piece);
  return (at(to) - at(from)) / (to - from);
}

}  // namespace extremal
