#include "study/constraints/constrained_extension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/limits.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<double> with_guesses(const Problem& problem, const Extension& extension, double tau) {
  std::vector<double> q(problem.coordinates());
  problem.guess.at(tau, q);
  q.insert(q.end(), extension.guess.begin(), extension.guess.end());
  q.resize(q.size() + extension.integrals.size(), 0.0);
  return q;
}

/// Rows of a relation as conditions of themselves, in the coordinates of the path and further ones.
std::vector<std::vector<Triplet>> rows_of(const BoundaryRelation& relation, int all) {
  std::vector<std::vector<Triplet>> rows(relation.rows);
  const int n = relation.coordinates;
  for (const Triplet& e : relation.matrix)
    rows[e.row].push_back({0, e.column < n ? e.column : all + e.column - n, e.value});
  return rows;
}

std::string text_of(const std::vector<Triplet>& row, double value, const std::vector<std::string>& names,
                    int all) {
  std::string text;
  for (const Triplet& e : row) {
    const std::string end = fmt::format("{}({})", names[e.column % all], e.column < all ? "0" : "T");
    text += e.value == 1 ? (text.empty() ? "" : " + ") + end
                         : fmt::format("{}{:.6g}*{}", text.empty() ? "" : " + ", e.value, end);
  }
  return text + fmt::format(" = {:.6g}", value);
}

/// Numbers of rows that are independent, the largest first.
std::vector<int> independent_rows(MatrixXd rows) {
  std::vector<int> found;
  std::vector<char> taken(rows.rows());
  while (std::ssize(found) < rows.rows()) {
    Index best = -1;
    for (Index k = 0; k < rows.rows(); ++k)
      if (!taken[k] && (best < 0 || rows.row(k).norm() > rows.row(best).norm())) best = k;
    if (best < 0 || !(rows.row(best).norm() > dependent_condition)) break;
    taken[best] = 1;
    found.push_back(static_cast<int>(best));
    const VectorXd direction = rows.row(best).normalized();
    for (Index k = 0; k < rows.rows(); ++k)
      if (!taken[k]) rows.row(k) -= (rows.row(k) * direction).value() * direction.transpose();
  }
  std::ranges::sort(found);
  return found;
}

/// A waypoint of a problem with constraints.
class ConstrainedPoint {
 public:
  ConstrainedPoint(const WaypointTable& table, const Problem& problem, WaypointCondition& waypoint)
      : table_(table), manifold_(*problem.manifold), waypoint_(waypoint) {
    const std::size_t n = problem.coordinates();
    time_ = waypoint.free ? 0 : waypoint.time;
    const double tau = waypoint.free ? 0.5 : waypoint.time / problem.duration.value;
    q_.resize(n);
    if (problem.guess.given())
      problem.guess.at(tau, q_);
    else
      for (std::size_t a = 0; a < n; ++a)
        q_[a] = (1 - tau) * problem.ends.offset[a] + tau * problem.ends.offset[n + a];
    std::vector<char> fixed(n);
    for (const auto& [a, value] : waypoint.fixed) {
      q_[a] = value;
      fixed[a] = 1;
    }
    for (std::size_t a = 0; a < n; ++a)
      if (!fixed[a]) free_.push_back(static_cast<int>(a));
  }

  void complete(const std::vector<Text>& constraints) {
    size_ = Eigen::Map<const VectorXd>(q_.data(), std::ssize(q_)).lpNorm<Eigen::Infinity>();
    if (!free_.empty()) meet_along_free();
    const ConstraintValues values = manifold_.at(q_, time_);
    if (!(manifold_.distance(q_, time_) <= end_distance * std::max(size_, 1e-300))) {
      Index worst = 0;
      values.g.cwiseAbs().maxCoeff(&worst);
      throw SceneError(table_.time.at,
                       fmt::format("the waypoint does not satisfy the constraint '{}': left − right = {:.6g} "
                                   "there; give values that do",
                                   constraints[worst].value, values.g[worst]));
    }
    if (!suits(values, determined_) || !suits_beside())
      throw SceneError(table_.time.at,
                       "the waypoint is fixed in part, and constraints link what is fixed with what is free; "
                       "give all of its coordinates");
    std::vector<double> moved = q_;
    manifold_.project(moved, time_);
    for (auto& [a, value] : waypoint_.fixed) value = moved[a];
    for (const int a : determined_) waypoint_.fixed.emplace_back(a, moved[a]);
    std::ranges::sort(waypoint_.fixed);
  }

 private:
  MatrixXd by_free(const ConstraintValues& values) const { return values.slopes(Eigen::all, free_); }

  void meet_along_free() {
    constexpr int most_steps = 50;
    for (int k = 0; k < most_steps; ++k) {
      const ConstraintValues values = manifold_.at(q_, time_);
      const VectorXd step = least_norm(by_free(values), -values.g);
      if (!step.allFinite()) return;
      for (std::size_t i = 0; i < free_.size(); ++i) q_[free_[i]] += step[static_cast<Index>(i)];
      if (step.norm() <= 1e-15 * size_) return;
    }
  }

  /// Directions of what is free that keep the constraints.
  MatrixXd along(const ConstraintValues& values) const {
    const MatrixXd g = by_free(values);
    const SingularValues parts = singular_value_decomposition(g);
    return parts.v.rightCols(parts.v.cols() - numerical_rank(g, rank));
  }

  /// At a point next to this one nothing else is determined.
  bool suits_beside() {
    if (determined_.size() == free_.size()) return true;
    const std::vector<double> here = q_;
    const MatrixXd moving = along(manifold_.at(q_, time_));
    VectorXd step = moving.col(0);
    for (Index k = 1; k < moving.cols(); ++k) step += (k % 2 ? -0.9 : 0.8) * moving.col(k);
    for (std::size_t i = 0; i < free_.size(); ++i)
      q_[free_[i]] += aside_part * size_ * step[static_cast<Index>(i)];
    meet_along_free();
    std::vector<int> there;
    const bool suited = suits(manifold_.at(q_, time_), there) && there == determined_;
    q_ = here;
    return suited;
  }

  /// Whether what is free moves along the manifold or normal to it; coordinates that are determined are
  /// found.
  bool suits(const ConstraintValues& values, std::vector<int>& determined) const {
    if (free_.empty()) return true;
    const MatrixXd moving = along(values);
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (moving.cols() == 0 || moving.row(static_cast<Index>(i)).norm() <= rank)
        determined.push_back(free_[i]);
    std::vector<int> left;
    std::ranges::set_difference(free_, determined, std::back_inserter(left));
    if (left.empty()) return true;
    const Index n = std::ssize(q_), f = std::ssize(left);
    MatrixXd z = MatrixXd::Zero(n, f);
    for (Index i = 0; i < f; ++i) z(left[i], i) = 1;
    MatrixXd across = manifold_.metric() * values.slopes.transpose();
    across.colwise().normalize();
    MatrixXd both(n, f + across.cols());
    both << z, across;
    const Index tangent = f - numerical_rank(values.slopes * z, rank);
    return tangent + f + numerical_rank(across, rank) - numerical_rank(both, rank) == f;
  }

  const WaypointTable& table_;
  const Manifold& manifold_;
  WaypointCondition& waypoint_;
  double time_ = 0, size_ = 0;
  std::vector<double> q_;
  std::vector<int> free_, determined_;
};

}  // namespace

ConditionsOnManifold::ConditionsOnManifold(const ConstrainedGraph& host, const Manifold& manifold,
                                           double duration)
    : ends_(moved_ends(host, normal_motion(manifold.metric(), manifold.rate(), host.coordinates), duration)) {
}

void ConditionsOnManifold::put_relation(const std::vector<std::string>& texts, Problem& problem,
                                        Extension& extension) const {
  const int n = problem.coordinates(), all = n + extension.constants();
  std::vector<EndCondition> conditions = std::move(extension.conditions);
  std::vector<std::string> names = texts, coordinates = problem.names;
  coordinates.resize(all);
  const auto rows = rows_of(problem.boundary, all);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double value = problem.boundary.value[k];
    conditions.push_back(linear_condition_of_points(rows[k], value, ends_));
    names.push_back(text_of(rows[k], value, coordinates, all));
  }
  const std::vector<double> start = with_guesses(problem, extension, 0),
                            end = with_guesses(problem, extension, 1);
  const auto width = static_cast<std::size_t>(all);
  MatrixXd slopes(std::ssize(conditions), 2 * n);
  std::vector<double> gradient(2 * width);
  for (Index k = 0; k < slopes.rows(); ++k) {
    conditions[k].function(start, end, gradient, {});
    for (int a = 0; a < n; ++a) {
      slopes(k, a) = gradient[a];
      slopes(k, n + a) = gradient[all + a];
    }
  }
  const std::vector<int> imposed = independent_rows(slopes);
  extension.conditions.clear();
  for (int k = 0; k < std::ssize(conditions); ++k)
    if (std::ranges::binary_search(imposed, k))
      extension.conditions.push_back(std::move(conditions[k]));
    else
      extension.implied.push_back({std::move(conditions[k]), names[k]});
  problem.boundary = {};
  problem.boundary.coordinates = n;
  problem.ends = solve_relation(problem.boundary);
}

void complete_waypoints(const Scene& scene, const Problem& problem,
                        std::vector<WaypointCondition>& waypoints) {
  for (std::size_t w = 0; w < waypoints.size(); ++w) {
    if (waypoints[w].free && !problem.manifold->autonomous())
      throw SceneError(scene.waypoints[w].time.at,
                       "at = \"free\" needs constraints and a Lagrangian that do not depend on t");
    ConstrainedPoint(scene.waypoints[w], problem, waypoints[w]).complete(scene.system.constraints);
  }
}

}  // namespace extremal
