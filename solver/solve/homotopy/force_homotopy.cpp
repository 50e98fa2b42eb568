#include "solve/homotopy/force_homotopy.hpp"

#include <utility>

namespace extremal {

ForceHomotopy::ForceHomotopy(const Problem& problem, Path& path, Workspace& workspace,
                             std::function<bool()> count, std::shared_ptr<WeakenedLagrangian> lagrangian)
    : Homotopy(path, workspace, std::move(count), 1), lagrangian_(std::move(lagrangian)), problem_(problem) {
  problem_.lagrangian = lagrangian_;
}

/// The gradient is linear in λ: its difference at λ + 1 is the derivative.
bool ForceHomotopy::solve_linearised(Move& correction, Move& direction) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  if (!model.evaluate(action, path_, nullptr) || !action.finite()) return false;
  model.solve(action, nullptr, correction.step);
  correction.parameter = 0;
  const double part = lagrangian_->part();
  lagrangian_->set_part(part + 1);
  model.evaluate_gradient(action, path_);
  model.solve(action, nullptr, direction.step);
  lagrangian_->set_part(part);
  direction.parameter = 0;
  direction.add(correction, -1);
  direction.parameter = 1;
  return true;
}

bool ForceHomotopy::trace(const ElementTables& tables) {
  lagrangian_->set_part(0);
  w_.iteration.reset(problem_, tables, path_.elements());
  Move correction, direction;
  if (!solve_linearised(correction, direction)) return false;
  path_.add(correction.step.nodes, correction.step.inner, 1);
  path_.load_ends();
  return begin(tables, most_steps_there) && find_tangent() && reach();
}

}  // namespace extremal
