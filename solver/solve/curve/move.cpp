#include "solve/curve/move.hpp"

#include <utility>

namespace extremal {

void Move::scale(double factor) {
  for (double& x : step.nodes) x *= factor;
  for (double& x : step.inner) x *= factor;
  for (double& x : times) x *= factor;
  step.duration *= factor;
  parameter *= factor;
}

void Move::add(const Move& other, double factor) {
  for (std::size_t k = 0; k < step.nodes.size(); ++k) step.nodes[k] += factor * other.step.nodes[k];
  for (std::size_t k = 0; k < step.inner.size(); ++k) step.inner[k] += factor * other.step.inner[k];
  for (std::size_t k = 0; k < times.size(); ++k) times[k] += factor * other.times[k];
  step.duration += factor * other.step.duration;
  parameter += factor * other.parameter;
}

void solve_with_duration(QuadraticModel& model, const DiscreteAction& action, const ClosingEquation& closing,
                         Move& move) {
  model.solve(action, &closing, move.step);
  move.parameter = std::exchange(move.step.duration, 0);
}

}  // namespace extremal
