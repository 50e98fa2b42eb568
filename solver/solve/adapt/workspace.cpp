#include "solve/adapt/workspace.hpp"

namespace extremal {

bool recover(const Problem& problem, const Path& path, Workspace& w, Path& recovered) {
  DiscreteAction& action = w.iteration.action();
  const int degree = path.degree(), raised = degree + Recovery::raised_by;
  if (!Recovery::suits(action.tables().scheme()) || !w.recovery.measure(*problem.lagrangian, action, path))
    return false;
  w.recovery.raise(path, w.levels.at(raised), w.levels.raise(degree, raised), recovered);
  return true;
}

}  // namespace extremal
