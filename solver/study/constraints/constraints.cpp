#include "study/constraints/constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "problem/nearby.hpp"
#include "study/constraints/limits.hpp"
#include "study/model/modelling.hpp"
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

void put_constraints(const ConstrainedGraph& graph, const System& system, const MatrixXd& metric, double rate,
                     bool deferred, Problem& problem) {
  ConstrainedSystem constrained = constrained_system(graph, system, metric, rate, deferred);
  problem.lagrangian = std::move(constrained.lagrangian);
  problem.copies = std::move(constrained.copies);
  problem.manifold = std::move(constrained.manifold);
}

/// What a deferred Lagrangian is taken to be.
bool may_be_deferred(const ConstrainedGraph& graph, const System& system, const Manifold& manifold) {
  const auto kinked = [&](NodeId f) { return has_kinks(graph.graph, f); };
  return graph.parameters.empty() && manifold.autonomous() &&
         (!system.copies || system.copies->structure().autonomous) && !kinked(graph.lagrangian) &&
         std::ranges::none_of(graph.forces, kinked);
}

/// L̃, and the Lagrangian of two copies that it has with the forces.
class ProjectedWithForces {
 public:
  ProjectedWithForces(ConstrainedGraph graph, NormalMotion normal)
      : graph_(std::move(graph)), normal_(std::move(normal)) {}

  std::shared_ptr<const Lagrangian> lagrangian() { return make_lagrangian(projected_once()); }
  std::shared_ptr<const Lagrangian> copies() {
    return make_lagrangian(two_copies(projected_once(), projected_power(graph_, normal_)));
  }

 private:
  const LagrangianGraph& projected_once() {
    std::call_once(once_, [this] { projected_ = projected(graph_, normal_); });
    return projected_;
  }

  ConstrainedGraph graph_;
  NormalMotion normal_;
  std::once_flag once_;
  LagrangianGraph projected_;
};

void check_counts(const SystemTable& table, const System& system) {
  const std::size_t n = system.names.size(), m = table.constraints.size();
  if (m >= n)
    throw SceneError(
        position(table.constraints[std::min(n - 1, m - 1)], 0),
        fmt::format(
            "{} constraints leave no motion to {} coordinates; fewer than {} can hold: leave out those "
            "that follow from others",
            m, n, n));
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
  const auto later = [n = graph.coordinates](int copies, DeferredLagrangian::Make make) {
    return std::make_shared<const DeferredLagrangian>(copies * n, std::move(make));
  };
  deferred = deferred && may_be_deferred(graph, system, *result.manifold);
  if (graph.forces.empty()) {
    const auto make = [graph, normal] { return make_lagrangian(projected(graph, normal)); };
    result.lagrangian = deferred ? later(1, make) : make();
    return result;
  }
  const auto made = std::make_shared<ProjectedWithForces>(graph, normal);
  const auto make = [made] { return made->lagrangian(); };
  const auto make_copies = [made] { return made->copies(); };
  result.lagrangian = deferred ? later(1, make) : make();
  result.copies = deferred ? later(2, make_copies) : make_copies();
  return result;
}

void constrain(const SystemTable& table, const System& system, double time, bool deferred, Problem& problem) {
  if (table.constraints.empty()) return;
  check_counts(table, system);
  problem.duration.value = time;
  put_constraints(make_constrained(table, system), system, metric_of(*system.lagrangian, problem),
                  (problem.initial ? growth_of_motions : growth) / time, deferred, problem);
}

void constrain_like(const Manifold& other, const SystemTable& table, const System& system, Problem& problem,
                    const std::vector<std::string>& active) {
  put_constraints(make_constrained(table, system, active), system, other.metric(), other.rate(), false,
                  problem);
}

ConstrainedGraph put_manifold_like(const Manifold& other, const SystemTable& table, const System& system,
                                   Problem& problem) {
  ConstrainedGraph graph = make_constrained(table, system);
  problem.lagrangian = system.lagrangian;
  problem.manifold = constrained_values(graph, system, other.metric(), other.rate());
  return graph;
}

}  // namespace extremal
