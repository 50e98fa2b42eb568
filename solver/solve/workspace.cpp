#include "solve/workspace.hpp"

namespace extremal {

void Outcome::record(const Workspace& workspace, const SolveOptions& options) {
  ++iterations;
  if (options.progress)
    options.progress({.elements = workspace.path.elements(),
                      .degree = workspace.path.degree(),
                      .residual = workspace.iteration.action().residual(),
                      .step = workspace.iteration.norm(),
                      .damping = workspace.iteration.damping()});
}

}  // namespace extremal
