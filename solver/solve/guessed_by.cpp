#include "solve/guessed_by.hpp"

namespace extremal {

Problem guessed_by(const Problem& problem, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = problem.coordinates();
  Problem result = problem;
  result.duration.value = trajectory.duration();
  result.guess = {};
  result.reduction = nullptr;
  std::vector<double> q(n), v(n);
  const int points = trajectory.degree * trajectory.elements();
  for (int k = 0; k <= points; ++k) {
    const double tau = static_cast<double>(k) / points;
    trajectory.at(tau * trajectory.duration(), q, v);
    result.guess.tau.push_back(tau);
    result.guess.q.insert(result.guess.q.end(), q.begin(), q.end());
  }
  return result;
}

}  // namespace extremal
