#include "solve/workspace.hpp"

#include <limits>

namespace extremal {

void Outcome::record(const Workspace& workspace, const SolveOptions& options) {
  constexpr double largest = std::numeric_limits<double>::max();
  const double residual = workspace.iteration.action().residual();
  ++iterations;
  if (options.progress)
    options.progress({.elements = workspace.path.elements(),
                      .degree = workspace.path.degree(),
                      .residual = residual <= largest ? residual : largest,  // where the action overflowed
                      .step = workspace.iteration.norm(),
                      .damping = workspace.iteration.damping()});
}

}  // namespace extremal
