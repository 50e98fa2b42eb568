#include "solution/from_minimal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "action/rule.hpp"
#include "problem/manifold.hpp"
#include "problem/point_range.hpp"
#include "solution/element_point.hpp"
#include "solution/limits.hpp"
#include "solution/one_copy.hpp"

namespace extremal {

namespace {

using namespace limits::minimal;

/// Points of q(u(t)) along a trajectory of u.
class Lift {
 public:
  Lift(const MinimalProblem& minimal, const Trajectory& path)
      : minimal_(minimal), path_(path), n_(minimal.whole->structure().coordinates) {}

  /// At these τ of each element, one element after the other; `nodal`: at its own nodes.
  LiftedPoints at(std::span<const double> taus, const Basis* nodal = nullptr) const {
    const std::size_t d = path_.coordinates, each = taus.size(), points = each * path_.elements();
    std::vector<double> u(points * d), du(points * d), t(points);
    std::array<double, max_degree + 1> value, derivative;
    for (std::size_t i = 0; i < each; ++i) {
      if (!nodal) lobatto_basis_at(path_.degree, taus[i], value.data(), derivative.data());
      const Basis::Row row = nodal ? nodal->row(i) : Basis::Row{value.data(), derivative.data()};
      std::size_t point = i;
      for (int k = 0; k < path_.elements(); ++k, point += each) {
        element_point(path_, k, row, &u[point * d], &du[point * d], 1);
        t[point] = path_.times[k] + taus[i] * path_.length(k);
      }
    }
    return lifted(minimal_, u, du, t);
  }

  /// With elements of this degree through points of q; `stretch` becomes the largest there.
  Trajectory trajectory(int degree, double& stretch) const {
    const Basis& basis = lobatto_nodal_basis(degree);
    LiftedPoints points = at(basis.points, degree == path_.degree ? &basis : nullptr);
    stretch = *std::ranges::max_element(points.stretch);
    Trajectory result;
    result.coordinates = n_;
    result.degree = degree;
    result.times = path_.times;
    result.lengths = path_.lengths;
    result.nodes = std::move(points.q);
    result.slopes = std::move(points.v);
    return result;
  }

 private:
  const MinimalProblem& minimal_;
  const Trajectory& path_;
  const int n_;
};

/// How far a trajectory of q is from q(u) between its nodes.
double missed(const Lift& lift, const Trajectory& trajectory) {
  const std::vector<double>& nodes = lobatto_nodal_basis(trajectory.degree).points;
  const std::size_t middle = nodes.size() / 2;
  const double taus[] = {(nodes[0] + nodes[1]) / 2, (nodes[middle - 1] + nodes[middle]) / 2};
  const LiftedPoints exact = lift.at(taus);
  const int n = trajectory.coordinates;
  std::vector<double> q(n), v(n);
  double most = 0;
  std::array<double, max_degree + 1> value, derivative;
  for (int i = 0; i < 2; ++i) {
    lobatto_basis_at(trajectory.degree, taus[i], value.data(), derivative.data());
    for (int k = 0; k < trajectory.elements(); ++k) {
      element_point(trajectory, k, {value.data(), derivative.data()}, q.data(), v.data(), 1);
      for (int a = 0; a < n; ++a) most = std::max(most, std::abs(q[a] - exact.q[(2 * k + i) * n + a]));
    }
  }
  return most;
}

double range_of(const Trajectory& trajectory) {
  return largest_range(trajectory.nodes, trajectory.coordinates);
}

/// Whether points and velocities are those of one motion on the manifold: the first and the middle node of
/// each element satisfy the constraints, and velocities integrate to the change of q over it. `error`: of q.
bool is_motion(const Manifold& manifold, const Trajectory& path, double error, double tolerance) {
  const std::size_t n = path.coordinates, s = path.degree, each = (s + 1) * n;
  const Rule rule = lobatto_rule(path.degree + 1);
  double size = 0;
  for (const double x : path.nodes) size = std::max(size, std::abs(x));
  const double rounded = roundings * size;
  const double speed_error = velocity_share * tolerance * largest_range(path.slopes, n);
  for (int k = 0; k < path.elements(); ++k) {
    const double h = path.length(k), *const q = &path.nodes[k * each], *const v = &path.slopes[k * each];
    for (const std::size_t j : {std::size_t{0}, s / 2})
      if (!(manifold.distance({q + j * n, n}, path.times[k] + rule.nodes[j] * h) <= error + rounded))
        return false;
    for (std::size_t a = 0; a < n; ++a) {
      double swept = 0;
      for (std::size_t j = 0; j <= s; ++j) swept += h * rule.weights[j] * v[j * n + a];
      if (!(std::abs(q[s * n + a] - q[a] - swept) <= most_errors * (error + h * speed_error) + rounded))
        return false;
    }
  }
  return true;
}

/// The momentum of L at an end, whose part along u is given.
void convert(const Manifold& manifold, const MinimalProblem& minimal, const Trajectory& trajectory, double t,
             std::vector<double>& momentum) {
  std::vector<double> q(trajectory.coordinates), v(q);
  trajectory.at(t, q, v);
  momentum = manifold.momentum(q, t, covector(minimal, q, momentum), v);
}

/// Whether the ends satisfy their relation, of which minimal coordinates may have taken a part for granted.
bool meets(const BoundaryRelation& relation, const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  std::vector<double> missed = relation.value, size(missed.size(), 0);
  const double range = range_of(trajectory);
  for (std::size_t k = 0; k < missed.size(); ++k) size[k] = std::abs(missed[k]);
  for (const Triplet& entry : relation.matrix) {
    const std::size_t column = entry.column;
    const std::size_t at = column < n ? column : trajectory.nodes.size() - 2 * n + column;
    const double term = entry.value * trajectory.nodes[at];
    missed[entry.row] -= term;
    size[entry.row] = std::max({size[entry.row], std::abs(entry.value) * range, std::abs(term)});
  }
  for (std::size_t k = 0; k < missed.size(); ++k)
    if (!(std::abs(missed[k]) <= relation_missed * size[k])) return false;
  return true;
}

}  // namespace

std::optional<Solution> from_minimal(const Problem& problem, const MinimalProblem& minimal, Solution solution,
                                     double tolerance, bool accepted) {
  const Trajectory path = std::move(solution.trajectory);
  const Lift lift(minimal, path);
  double between = 0, error = 0;
  for (int degree = path.degree;; degree = std::min(degree + raise, max_degree)) {
    double stretch = 1;
    solution.trajectory = lift.trajectory(degree, stretch);
    const double own = solution.error_estimate * (degree == path.degree ? std::max(stretch, 1.0) : 1);
    if (degree == path.degree) {
      solution.error_estimate = own;
      error = std::max(tolerance * range_of(solution.trajectory), accepted ? own : 0);
    }
    between = missed(lift, solution.trajectory);
    if (between <= between_nodes * std::max(own, error) || degree == max_degree) break;
  }
  if (between > between_nodes * error) solution.error_estimate += between;
  if (!(solution.error_estimate <= error) || !meets(problem.boundary, solution.trajectory) ||
      !is_motion(*problem.manifold, solution.trajectory, error, tolerance))
    return std::nullopt;
  convert(*problem.manifold, minimal, solution.trajectory, 0, solution.momentum_start);
  convert(*problem.manifold, minimal, solution.trajectory, solution.duration(), solution.momentum_end);
  if (!problem.manifold->autonomous()) {
    solution.energy = solution.energy_drift = std::nullopt;
    if (solution.work) solution.work = work_under_constraints(*problem.manifold, solution.trajectory);
  }
  if (solution.floquet) solution.floquet->vectors.clear();
  return solution;
}

}  // namespace extremal
