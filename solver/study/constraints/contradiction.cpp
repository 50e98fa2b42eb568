#include "study/constraints/contradiction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/limits.hpp"

namespace extremal {
namespace {

namespace limit = limits::contradiction;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The first constraint that cannot be met together with those before it, and what its sides differ by where
/// it comes nearest.
struct Unmet {
  Index constraint;
  double difference;
};

/// Meets constraints one after the other, at one time, in displacements that are the columns of `free`.
class OneByOne {
 public:
  OneByOne(const Manifold& manifold, MatrixXd free, double t)
      : manifold_(manifold), free_(std::move(free)), t_(t) {}

  /// From q. Nothing if all are met, or if those before one are lost.
  std::optional<Unmet> unmet(VectorXd q) const {
    for (Index k = 0; k < manifold_.constraints(); ++k) {
      const std::optional<double> left = approach(k, q);
      if (!left) return std::nullopt;
      if (!met(k, q)) return Unmet{k, *left};
    }
    return std::nullopt;
  }

 private:
  ConstraintValues at(const VectorXd& q) const { return manifold_.at({q.data(), std::size_t(q.size())}, t_); }

  /// ∂g_k/∂q along the displacements, as a column.
  VectorXd slope(const ConstraintValues& values, Index k) const {
    return free_.transpose() * values.slopes.row(k).transpose();
  }

  bool met(Index k, const VectorXd& q) const {
    const ConstraintValues values = at(q);
    const double size = std::max(q.lpNorm<Eigen::Infinity>(), 1e-300);
    return std::abs(values.g[k]) <= limits::constraints::end_distance * size * slope(values, k).norm();
  }

  /// Newton's method for the first `count`, with shortest steps.
  bool hold(Index count, VectorXd& q) const {
    if (count == 0) return true;
    for (int step = 0; step < limit::most_corrections; ++step) {
      const ConstraintValues values = at(q);
      const VectorXd change = free_ * least_norm(values.slopes.topRows(count) * free_, -values.g.head(count));
      if (!change.allFinite()) return false;
      q += change;
      if (change.norm() <= limits::constraints::end_distance * q.norm()) break;
    }
    for (Index k = 0; k < count; ++k)
      if (!met(k, q)) return false;
    return true;
  }

  /// g_k nearest to zero where those before it hold, and q there: steps along its slope tangent to their
  /// surfaces, as long as it falls. Nothing where they cannot be held.
  std::optional<double> approach(Index k, VectorXd& q) const {
    if (!hold(k, q)) return std::nullopt;
    double g = at(q).g[k];
    for (int step = 0; step < limit::most_approaches && !met(k, q); ++step) {
      const ConstraintValues values = at(q);
      VectorXd along = slope(values, k);
      if (k > 0) {
        const MatrixXd before = (values.slopes.topRows(k) * free_).transpose();
        along -= before * least_norm(before, along);
      }
      if (!(along.norm() > limits::constraints::dependence * slope(values, k).norm())) break;
      const VectorXd whole = free_ * along * (-g / along.squaredNorm());
      const double last = g;
      for (double part = 1; part >= limit::least_part && g == last; part /= 2) {
        VectorXd there = q + part * whole;
        if (!hold(k, there)) continue;
        if (const double reached = at(there).g[k]; std::abs(reached) < std::abs(g)) {
          g = reached;
          q = std::move(there);
        }
      }
      if (!(std::abs(g) < (1 - limit::least_fall) * std::abs(last))) break;
    }
    return g;
  }

  const Manifold& manifold_;
  const MatrixXd free_;
  const double t_;
};

/// Of all starts what comes farthest, and there nearest; nothing if one of them meets all constraints, or
/// none tells.
class Farthest {
 public:
  void add(const std::optional<Unmet>& unmet) {
    if (!unmet) {
      known_ = false;
    } else if (!best_ || unmet->constraint > best_->constraint ||
               (unmet->constraint == best_->constraint &&
                std::abs(unmet->difference) < std::abs(best_->difference))) {
      best_ = unmet;
    }
  }
  bool known() const { return known_; }
  std::optional<Unmet> found() const { return known_ ? best_ : std::nullopt; }

 private:
  bool known_ = true;
  std::optional<Unmet> best_;
};

VectorXd aside(Index n, double size, int seed) {
  VectorXd result(n);
  for (Index a = 0; a < n; ++a) result[a] = size * std::cos(1.0 + double(a) + 2.4 * seed);
  return result;
}

/// What is given at each end.
void check_ends(const Scene& scene, const Problem& problem, const Eigen::Ref<const MatrixXd>& points,
                double size) {
  const Index n = problem.coordinates();
  MatrixXd z = MatrixXd::Zero(2 * n, problem.ends.free);
  for (const Triplet& entry : problem.ends.z) z(entry.row, entry.column) += entry.value;
  const Eigen::Map<const VectorXd> offset(problem.ends.offset.data(), 2 * n);
  for (const bool at_end : {false, true}) {
    const Index first = at_end ? n : 0;
    const MatrixXd free = z.middleRows(first, n);
    if (free.norm() == 0) continue;
    const VectorXd fixed = offset.segment(first, n), near = points.col(at_end ? points.cols() - 1 : 0);
    const OneByOne along(*problem.manifold, free, at_end ? problem.duration.value : 0.0);
    Farthest of_end;
    for (int seed = 0; seed < limit::tries && of_end.known(); ++seed)
      of_end.add(along.unmet(fixed + free * least_norm(free, near + aside(n, seed * size, seed) - fixed)));
    const std::optional<Unmet> found = of_end.found();
    if (!found) continue;
    const std::vector<Assignment>& given = at_end ? scene.boundary.end : scene.boundary.start;
    throw SceneError(
        given.empty() ? scene.boundary.at : given.front().name_at,
        fmt::format("no point near the guess satisfies both the constraints and what is given at "
                    "the {}: of '{}' left − right = {:.6g} remains; give other values",
                    at_end ? "end" : "start", scene.system.constraints[found->constraint].value,
                    found->difference));
  }
}

}  // namespace

void check_contradictions(const Scene& scene, const Problem& problem, const std::vector<double>& points) {
  const Index n = problem.coordinates(), count = std::ssize(points) / n;
  const Eigen::Map<const MatrixXd> all(points.data(), n, count);
  const double largest = all.cwiseAbs().maxCoeff(), size = largest > 0 ? largest : 1;
  const double T = problem.duration.value;

  Farthest of_constraints;
  for (int part = 0; part <= limit::parts; ++part) {
    const OneByOne anywhere(*problem.manifold, MatrixXd::Identity(n, n), T * part / limit::parts);
    for (int seed = 0; seed < limit::tries && of_constraints.known(); ++seed)
      of_constraints.add(
          anywhere.unmet(all.col((count - 1) * part / limit::parts) + aside(n, seed * size, seed)));
  }
  if (const std::optional<Unmet> found = of_constraints.found()) {
    const Text& text = scene.system.constraints[found->constraint];
    throw SceneError(
        position(text, 0),
        fmt::format("the constraint '{}' {} near the guess: left − right = {:.6g} is the least there; "
                    "correct it, or give a guess near points where all constraints hold",
                    text.value, found->constraint > 0 ? "contradicts the ones before it" : "cannot hold",
                    found->difference));
  }
  if (!problem.periodic) check_ends(scene, problem, all, size);
}

}  // namespace extremal
