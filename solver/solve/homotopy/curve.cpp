#include "solve/homotopy/curve.hpp"

#include <cmath>
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

/// α from the border's equation, which the correction misses by `off` and the direction changes by `along`.
bool BorderedSteps::solve(Factors factors) {
  if (!curve.linearise(factors)) return false;
  const Move& towards = border.tangent ? *border.tangent : curve.direction;
  const double along = border.value ? curve.change(true) : curve.dot(towards, curve.direction);
  const double off = border.value ? curve.varied() + curve.change(false) - *border.value
                                  : curve.dot(towards, curve.correction) + curve.drift(towards);
  if (along == 0) return false;
  curve.correction.add(curve.direction, -off / along);
  return true;
}

void solve_with_duration(QuadraticModel& model, const DiscreteAction& action, const ClosingEquation& closing,
                         Move& move) {
  model.solve(action, &closing, move.step);
  move.parameter = std::exchange(move.step.duration, 0);
}

TangentScale tangent_scale(const ExtremalCurve& curve, const Move* before, double sense) {
  const double length = std::sqrt(curve.dot(curve.direction, curve.direction));
  const double along = before ? curve.dot(*before, curve.direction) : sense;
  return {std::copysign(1 / length, along),
          before ? std::abs(along) / (length * std::sqrt(curve.dot(*before, *before))) : 1};
}

}  // namespace extremal
