#include "solve/adapt/workspace.hpp"

namespace extremal {

bool recover(const Problem& problem, const Path& path, Workspace& w, Path& recovered) {
  return recover(*problem.lagrangian, w.iteration.action(), path, w.recovery, w.levels, recovered);
}

bool recover(const Lagrangian& lagrangian, DiscreteAction& action, const Path& path, Recovery& recovery,
             Levels& levels, Path& recovered) {
  const int degree = path.degree(), raised = degree + Recovery::raised_by;
  if (!Recovery::suits(action.tables().scheme()) || !recovery.measure(lagrangian, action, path)) return false;
  recovery.raise(path, levels.at(raised), levels.raise(degree, raised), recovered);
  return true;
}

}  // namespace extremal
