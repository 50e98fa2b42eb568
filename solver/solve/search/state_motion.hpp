#pragma once

#include <Eigen/Dense>
#include <functional>

#include "linear/dense.hpp"
#include "motion/dop853.hpp"
#include "solve/search/limits.hpp"

/// \file Motions of a scan as states at their end.

namespace extremal {

/// Moves y, a state (q, p) of 2n entries and perhaps its variations, from t = 0 to `duration`. Errors of
/// steps are those of the state. `more` is told `cost` times the steps. False if there is no motion until
/// then.
template <class Slope>
bool move_state(const Slope& slope, int n, double duration, double tolerance, int cost,
                const std::function<bool(int steps)>& more, Eigen::VectorXd& y) {
  DormandPrince<double> method(slope, static_cast<int>(y.size()));
  IntegrationOptions options;
  options.tolerance = tolerance;
  options.block = n;
  options.controlled = 2 * n;
  options.max_steps = limits::scanned_motions::most_integrator_steps;
  double t = 0;
  const Integrated result = method.advance(t, span_of(y), duration, options);
  more(cost * (method.steps() + method.rejected()));
  return result == Integrated::done;
}

}  // namespace extremal
