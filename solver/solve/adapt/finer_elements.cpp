#include "solve/adapt/finer_elements.hpp"

#include <algorithm>

namespace extremal {

Path& on_finer_elements(const Problem& problem, const Path& path, const ElementTables& tables, int raised,
                        Workspace& workspace) {
  const int degree = std::min(path.degree() + raised, max_degree);
  const ElementTables& finer = workspace.levels.at(degree);
  workspace.other.interpolate_from(path, finer, workspace.levels.raise(path.degree(), degree));
  workspace.iteration.reset(problem, finer, path.elements());
  workspace.iteration.forget();
  workspace.iteration.set_scale(scales(path, tables).q);
  return workspace.other;
}

}  // namespace extremal
