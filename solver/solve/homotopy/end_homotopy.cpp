#include "solve/homotopy/end_homotopy.hpp"
#include "solve/homotopy/limits.hpp"

#include "linear/dense.hpp"

namespace extremal {

using namespace limits::end_homotopy;

std::vector<double> unit_displacement(const BoundaryRelation& relation, int row) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(relation.rows, 2 * relation.coordinates);
  for (const Triplet& entry : relation.matrix) matrix(entry.row, entry.column) += entry.value;
  const Eigen::VectorXd x = least_norm(matrix, Eigen::VectorXd::Unit(relation.rows, row));
  return {x.begin(), x.end()};
}

EndHomotopy::EndHomotopy(const Problem& problem, Path& path, Workspace& workspace,
                         std::function<bool()> count, std::vector<double> displacement, double unit)
    : Homotopy(path, workspace, std::move(count), unit),
      problem_(problem),
      ends_(std::move(displacement)),
      unit_(unit) {}

bool EndHomotopy::set_parameter(double value) {
  parameter_ = value;
  return true;
}

/// At the nodes of the path, with `inner` zeros for the unknowns that move with them.
void EndHomotopy::sample_displacement(std::size_t inner) {
  const std::size_t n = problem_.coordinates();
  displacement_.inner.assign(inner, 0);
  displacement_.nodes.clear();
  for (const double tau : path_.mesh())
    for (std::size_t a = 0; a < n; ++a)
      displacement_.nodes.push_back((1 - tau) * ends_[a] + tau * ends_[n + a]);
}

/// The path moved along a line x(τ) whose ends meet the row, and a Newton step from there: H δx = −g at the
/// path and at the one moved by a little give the direction.
bool EndHomotopy::solve_linearised(Move& correction, Move& direction) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  if (!model.evaluate(action, path_, w_.iteration.closing(path_)) || !action.finite()) return false;
  model.solve(action, w_.iteration.closing(path_), correction.step);
  correction.parameter = 0;
  const double by = small * unit_;
  at_ = path_;
  sample_displacement(correction.step.inner.size());
  path_.add(displacement_.nodes, displacement_.inner, by);
  path_.load_ends();
  model.evaluate_gradient(action, path_);
  model.solve(action, w_.iteration.closing(path_), direction.step);
  path_.copy_values(at_);
  path_.load_ends();
  direction.parameter = 0;
  direction.add(correction, -1);
  for (double& x : direction.step.nodes) x /= by;
  for (double& x : direction.step.inner) x /= by;
  direction.step.duration /= by;
  for (std::size_t k = 0; k < displacement_.nodes.size(); ++k)
    direction.step.nodes[k] += displacement_.nodes[k];
  direction.parameter = 1;
  return true;
}

bool EndHomotopy::trace(const ElementTables& tables, double parameter) {
  sense_ = 0;
  parameter_ = parameter;
  return begin(tables, most_steps_there) && approach() && find_tangent() && reach();
}

bool EndHomotopy::leave(const ElementTables& tables, bool along) {
  sense_ = along ? 1 : -1;
  parameter_ = 0;
  return begin(tables, most_steps_on) && find_tangent();
}

}  // namespace extremal
