#include "study/constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "problem/nearby.hpp"
#include "study/limits.hpp"
#include "study/modelling.hpp"
#include "system/constraints.hpp"
#include "system/copies.hpp"
#include "system/deferred_lagrangian.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The mean of ∂²L/∂q'² over coordinates and points.
double mean_mass(const Lagrangian& lagrangian, const Problem& problem) {
  const std::size_t n = problem.coordinates();
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, v;
  double sum = 0;
  int found = 0;
  for (int k = 0; k < mass_points; ++k) {
    const double t = points.next(q, v);
    const PointValues values = evaluate_at(lagrangian, q, v, t, Order::hessian, scratch);
    double trace = 0;
    for (std::size_t a = 0; a < n; ++a) trace += std::abs(values.vv[a * n + a]);
    if (!std::isfinite(trace) || trace == 0) continue;
    sum += trace / static_cast<double>(n);
    ++found;
  }
  return found > 0 ? sum / found : 1;
}

/// The inverse of a constant positive definite mass matrix, else that of the mean mass: symmetries of L then
/// are isometries.
MatrixXd metric_of(const Lagrangian& lagrangian, const Problem& problem) {
  const Structure& structure = lagrangian.structure();
  const Index n = problem.coordinates();
  if (structure.quadratic) {
    MatrixXd mass = MatrixXd::Zero(n, n);
    for (const Triplet& m : structure.mass) mass(m.row, m.column) += m.value;
    const auto factors = mass.llt();
    if (factors.info() == Eigen::Success && factors.rcond() > least_rcond)
      return factors.solve(MatrixXd::Identity(n, n));
  }
  return MatrixXd::Identity(n, n) / mean_mass(lagrangian, problem);
}

void put_constraints(const SystemTable& table, const System& system, const MatrixXd& metric, double rate,
                     bool deferred, Problem& problem) {
  ConstrainedSystem constrained =
      constrained_system(make_constrained(table, system), system, metric, rate, deferred);
  problem.lagrangian = std::move(constrained.lagrangian);
  problem.copies = std::move(constrained.copies);
  problem.manifold = std::move(constrained.manifold);
}

void check_counts(const SystemTable& table, const System& system) {
  const std::size_t n = system.names.size(), m = table.constraints.size();
  if (m >= n)
    throw SceneError(
        position(table.constraints[std::min(n - 1, m - 1)], 0),
        fmt::format("{} constraints leave no motion to {} coordinates; fewer than {} can hold", m, n, n));
  if (n > most_coordinates)
    throw SceneError(position(table.constraints.front(), 0),
                     fmt::format("constraints of {} coordinates; {} are the most", n, most_coordinates));
}

}  // namespace

MatrixXd metric_of_motion(const System& system, const Problem& problem) {
  return metric_of(*system.lagrangian, problem);
}

std::shared_ptr<const Manifold> constrained_values(const ConstrainedGraph& graph, const System& system,
                                                   const MatrixXd& metric, double rate) {
  return std::make_shared<const Manifold>(
      Manifold::Parts{system.lagrangian, make_lagrangian(with_time_as_coordinate(graph)),
                      make_lagrangian(multiplier_form(graph)), metric, rate, system.copies});
}

NormalMotion normal_motion(const MatrixXd& metric, double rate, int coordinates) {
  NormalMotion normal{{}, rate, coordinates - static_cast<int>(metric.rows())};
  for (Index a = 0; a < metric.rows(); ++a)
    for (Index b = 0; b < metric.cols(); ++b)
      if (metric(a, b) != 0)
        normal.metric.push_back({static_cast<int>(a), static_cast<int>(b), metric(a, b)});
  return normal;
}

ConstrainedSystem constrained_system(const ConstrainedGraph& graph, const System& system,
                                     const MatrixXd& metric, double rate, bool deferred) {
  const NormalMotion normal = normal_motion(metric, rate, graph.coordinates);
  ConstrainedSystem result;
  result.manifold = constrained_values(graph, system, metric, rate);
  if (graph.constraints.size() >= system.names.size()) return result;
  if (!graph.forces.empty()) {
    const LagrangianGraph lagrangian = projected(graph, normal);
    result.lagrangian = make_lagrangian(lagrangian);
    result.copies = make_lagrangian(two_copies(lagrangian, projected_power(graph, normal)));
    return result;
  }
  if (deferred && graph.parameters.empty() && result.manifold->autonomous() &&
      !has_kinks(graph.graph, graph.lagrangian))
    result.lagrangian = std::make_shared<const DeferredLagrangian>(
        graph.coordinates, [graph, normal] { return make_lagrangian(projected(graph, normal)); });
  else
    result.lagrangian = make_lagrangian(projected(graph, normal));
  return result;
}

void constrain(const SystemTable& table, const System& system, double time, bool deferred, Problem& problem) {
  if (table.constraints.empty()) return;
  check_counts(table, system);
  problem.duration.value = time;
  put_constraints(table, system, metric_of(*system.lagrangian, problem),
                  (problem.initial ? growth_of_motions : growth) / time, deferred, problem);
}

void constrain_like(const Manifold& other, const SystemTable& table, const System& system, Problem& problem) {
  put_constraints(table, system, other.metric(), other.rate(), false, problem);
}

ConstrainedGraph put_manifold_like(const Manifold& other, const SystemTable& table, const System& system,
                                   Problem& problem) {
  ConstrainedGraph graph = make_constrained(table, system);
  problem.lagrangian = system.lagrangian;
  problem.manifold = constrained_values(graph, system, other.metric(), other.rate());
  return graph;
}

}  // namespace extremal
