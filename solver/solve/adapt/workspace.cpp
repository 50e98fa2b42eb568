#include "solve/adapt/workspace.hpp"

#include <limits>

namespace extremal {

bool recover(const Problem& problem, Workspace& w) {
  DiscreteAction& action = w.iteration.action();
  const int degree = w.path.degree();
  if (!Recovery::suits(action.tables().scheme()) || !w.recovery.measure(*problem.lagrangian, action, w.path))
    return false;
  const int raised = degree + Recovery::raised_by;
  w.recovery.raise(w.path, w.levels.at(raised), w.levels.raise(degree, raised), w.recovered);
  return true;
}

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
