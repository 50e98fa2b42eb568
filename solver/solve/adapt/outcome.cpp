#include "solve/adapt/outcome.hpp"

#include <limits>

namespace extremal {

void Outcome::record(const NewtonIteration& newton, const SolveOptions& options) {
  constexpr double largest = std::numeric_limits<double>::max();
  const double residual = newton.action().residual();
  ++attempts;
  if (newton.action().finite()) ++iterations;
  if (options.progress)
    options.progress({.elements = path.elements(),
                      .degree = path.degree(),
                      .residual = residual <= largest ? residual : largest,  // where the action overflowed
                      .step = newton.norm(),
                      .damping = newton.damping()});
}

}  // namespace extremal
