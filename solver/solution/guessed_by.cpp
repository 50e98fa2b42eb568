#include "solution/guessed_by.hpp"

#include <vector>

namespace extremal {

Guess guess_of(const Trajectory& trajectory, int samples_an_element) {
  const int count = samples_an_element > 0 ? samples_an_element : trajectory.degree;
  Guess guess;
  std::vector<double> q(trajectory.coordinates), v(q.size());
  const auto add = [&](double tau) {
    guess.tau.push_back(tau);
    guess.q.insert(guess.q.end(), q.begin(), q.end());
  };
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int i = 0; i < count; ++i) {
      const double part = static_cast<double>(i) / count;
      const double tau = (trajectory.times[k] + part * trajectory.length(k)) / trajectory.duration();
      if (!guess.tau.empty() && !(tau > guess.tau.back() && tau < 1)) continue;  // by roundoff
      trajectory.in_element(k, part, q, v);
      add(tau);
    }
  trajectory.at(trajectory.duration(), q, v);
  add(1);
  return guess;
}

Problem guessed_by(const Problem& problem, const Solution& solution) {
  Problem result = problem;
  result.duration.value = solution.trajectory.duration();
  result.guess = guess_of(solution.trajectory);
  result.reduction = nullptr;
  return result;
}

}  // namespace extremal
