#include "solution/on_manifold.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "problem/manifold.hpp"
#include "solution/limits.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;

/// Moves the nodes; returns how far at the most, infinite where one cannot be moved.
double move_nodes(const Manifold& manifold, Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates, s = trajectory.degree;
  const Basis& basis = lobatto_nodal_basis(trajectory.degree);
  double most = 0;
  std::vector<double> q(n);
  for (int k = 0; k < trajectory.elements(); ++k)
    for (std::size_t j = 0; j <= s; ++j) {
      const std::size_t first = (k * (s + 1) + j) * n;
      const double t = trajectory.times[k] + basis.points[j] * trajectory.length(k);
      const std::span<double> node(trajectory.nodes.data() + first, n);
      std::copy(node.begin(), node.end(), q.begin());
      if (!manifold.project(node, t)) return INFINITY;
      for (std::size_t a = 0; a < n; ++a) most = std::max(most, std::abs(node[a] - q[a]));
      if (!trajectory.slopes.empty()) manifold.make_tangent(node, t, {trajectory.slopes.data() + first, n});
    }
  return most;
}

/// By how far the nodes of a solution were moved.
void refuse_off_manifold(const Manifold& manifold, double moved, Solution& solution) {
  const std::size_t n = solution.trajectory.coordinates;
  double size = n > 0 ? manifold.radius({solution.trajectory.nodes.data(), n}, 0) : 0;
  for (const double x : solution.trajectory.nodes) size = std::max(size, std::abs(x));
  if (moved <=
      limits::on_manifold::most_moved * solution.error_estimate + limits::on_manifold::roundings * size)
    return;
  solution.status = Status::not_converged;
  solution.message =
      std::isfinite(moved)
          ? fmt::format(
                "the path found is off the constraints by {:.1e}, its error is {:.1e}; give another guess",
                moved, solution.error_estimate)
          : "the path found is so far off the constraints that it cannot be moved onto them; give another "
            "guess";
}

/// The momentum of L at an end, of which that of L̃ is the projection.
void convert(const Manifold& manifold, const Trajectory& trajectory, double t,
             std::vector<double>& momentum) {
  if (momentum.empty()) return;
  std::vector<double> q(trajectory.coordinates), v(q);
  trajectory.at(t, q, v);
  manifold.project(q, t);
  manifold.make_tangent(q, t, v);
  momentum = manifold.momentum(q, t, momentum, v);
}

/// The multipliers of what is beside the manifold. There the path closes as c(T) = S c(0), and its linear
/// motion is c'' = ω² c.
VectorXcd normal_multipliers(const Problem& problem, const Trajectory& trajectory) {
  const Manifold& manifold = *problem.manifold;
  const ClosingMap map = closing_map(problem);
  std::vector<double> start(trajectory.coordinates), end(start), v(start);
  trajectory.at(0, start, v);
  trajectory.at(trajectory.duration(), end, v);
  const auto normals = [&](std::vector<double>& q, double t) {
    MatrixXd rows = manifold.at(q, t).slopes;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) {
      const double size = std::sqrt((rows.row(k) * manifold.metric() * rows.row(k).transpose()).value());
      rows.row(k) /= size;
    }
    return rows;
  };
  // c(R q) = S c(q), so that C(Rq) R = S C(q).
  const MatrixXd before = normals(start, 0), after = normals(end, trajectory.duration()) * map.r;
  return general_eigenvalues(inverse(least_norm(before.transpose(), after.transpose()).transpose()));
}

void leave_out(const VectorXcd& turns, double growth, Floquet& floquet) {
  std::vector<char> left_out(floquet.multipliers.size(), 0);
  for (Eigen::Index k = 0; k < turns.size(); ++k)
    for (const double factor : {growth, 1 / growth}) {
      const std::complex<double> wanted = turns[k] * factor;
      std::size_t nearest = 0;
      double least = INFINITY;
      for (std::size_t i = 0; i < left_out.size(); ++i)
        if (const double distance = std::abs(floquet.multipliers[i] - wanted) / std::abs(wanted);
            !left_out[i] && distance < least) {
          least = distance;
          nearest = i;
        }
      if (std::isfinite(least)) left_out[nearest] = 1;
    }
  const auto keep = [&](auto& list) {
    if (list.size() != left_out.size()) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < left_out.size(); ++i)
      if (!left_out[i]) {
        if (to != i) list[to] = std::move(list[i]);
        ++to;
      }
    list.resize(to);
  };
  keep(floquet.multipliers);
  keep(floquet.krein);
  keep(floquet.vectors);
  // Each pair is real, but where S turns constraints into each other.
  for (Eigen::Index k = 0; k < turns.size(); ++k)
    if (std::abs(turns[k].imag()) < limits::on_manifold::real)
      floquet.real_pairs = std::max(0, floquet.real_pairs - 1);
    else if (turns[k].imag() > 0)
      floquet.quadruples = std::max(0, floquet.quadruples - 1);
}

}  // namespace

void leave_out_normal(const Problem& problem, const Trajectory& trajectory, Floquet& floquet) {
  leave_out(normal_multipliers(problem, trajectory),
            std::exp(problem.manifold->rate() * trajectory.duration()), floquet);
}

void check_on_manifold(const Problem& problem, Solution& solution) {
  Trajectory trajectory = solution.trajectory;
  refuse_off_manifold(*problem.manifold, move_nodes(*problem.manifold, trajectory), solution);
}

void move_onto_manifold(const Problem& problem, Solution& solution) {
  if (!solution.converged()) return;
  Trajectory& trajectory = solution.trajectory;
  const Manifold& manifold = *problem.manifold;
  refuse_off_manifold(manifold, move_nodes(manifold, trajectory), solution);
  if (!solution.converged()) return;
  if (solution.floquet) leave_out_normal(problem, trajectory, *solution.floquet);
  convert(manifold, trajectory, 0, solution.momentum_start);
  convert(manifold, trajectory, trajectory.duration(), solution.momentum_end);
  if (!manifold.autonomous()) solution.energy = solution.energy_drift = std::nullopt;
}

}  // namespace extremal
