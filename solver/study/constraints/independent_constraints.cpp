#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/constraints.hpp"
#include "study/constraints/limits.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A point at which the first `count` constraints hold, near q. False where there is none near.
bool meet_first(const Manifold& manifold, Index count, double t, std::vector<double>& q) {
  constexpr int most_steps = 50;
  Eigen::Map<VectorXd> point(q.data(), std::ssize(q));
  for (int step = 0; step < most_steps; ++step) {
    const ConstraintValues values = manifold.at(q, t);
    const VectorXd change = least_norm(values.slopes.topRows(count), -values.g.head(count));
    if (!change.allFinite()) return false;
    point += change;
    if (change.norm() <= end_distance * aside_part * point.norm()) return true;
  }
  return false;
}

/// Whether the gradient of a constraint vanishes where it holds near q, as that of a square does: Newton's
/// method beside there takes the same part of the way in each step.
bool has_no_gradient(const Manifold& manifold, Index k, double t, std::vector<double> q) {
  constexpr int most_steps = 60;
  constexpr double near = 1e-5, least_part_left = 0.4;
  Eigen::Map<VectorXd> point(q.data(), std::ssize(q));
  const double size = point.norm() > 0 ? point.norm() : 1;
  for (Index a = 0; a < point.size(); ++a) point[a] += aside_part * size * std::cos(1.0 + double(a));
  double before = INFINITY;
  for (int step = 0; step < most_steps; ++step) {
    const ConstraintValues values = manifold.at(q, t);
    const VectorXd slope = values.slopes.row(k);
    const double length = std::abs(values.g[k]) / slope.norm();
    if (!std::isfinite(length)) return false;
    if (before <= near * size) return length > least_part_left * before;
    point -= values.g[k] / slope.squaredNorm() * slope;
    before = length;
  }
  return false;
}

/// Which constraints have gradients that are made of those before them, as points are looked at.
class Dependence {
 public:
  explicit Dependence(const Manifold& manifold)
      : manifold_(manifold),
        found_(manifold.constraints(), 1),
        flat_(manifold.constraints(), 1),
        missed_(manifold.constraints(), INFINITY),
        differences_(manifold.constraints(), 0) {}

  /// At a point, on the manifold if it can be moved there.
  void look_near(const std::vector<double>& q, double t) {
    std::vector<double> moved = q;
    for (std::size_t k = 0; k < flat_.size(); ++k)
      flat_[k] &= has_no_gradient(manifold_, static_cast<Index>(k), t, q);
    const bool met = manifold_.project(moved, t);
    if (!met) moved = q;
    look(met || meet_first(manifold_, manifold_.constraints(), t, moved) ? moved : q, t);
    points_.push_back(std::move(moved));
    times_.push_back(t);
  }

  /// The first that depends on others at all points, or -1.
  int first() const {
    const auto found = std::ranges::find(found_, 1);
    return found == found_.end() ? -1 : static_cast<int>(found - found_.begin());
  }
  /// The first whose own gradient vanishes at all points where it holds, or -1.
  int flat() const {
    const auto found = std::ranges::find(flat_, 1);
    return found == flat_.end() ? -1 : static_cast<int>(found - flat_.begin());
  }
  /// By how much it is missed at the least where those before it hold, to first order, in units of q.
  double missed(int k) const { return missed_[k]; }
  /// What its sides differ by there.
  double difference(int k) const { return differences_[k]; }

  /// By how much it is missed at the most beside the points, where those before it hold, by the distance.
  double missed_beside(int k) const {
    double most = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::vector<double> q = points_[i];
      const double size = Eigen::Map<const VectorXd>(q.data(), std::ssize(q)).norm();
      const double aside = aside_part * (size > 0 ? size : 1);
      for (std::size_t a = 0; a < q.size(); ++a) q[a] += aside * std::cos(1.0 + static_cast<double>(a));
      if (!meet_first(manifold_, k, times_[i], q)) continue;
      const ConstraintValues values = manifold_.at(q, times_[i]);
      const double slope = values.slopes.row(k).norm();
      if (slope > 0) most = std::max(most, std::abs(values.g[k]) / (slope * aside));
    }
    return most;
  }

 private:
  /// The elimination that leaves of a gradient what is no part of those before leaves of g what remains
  /// where those vanish.
  void look(const std::vector<double>& q, double t) {
    const ConstraintValues values = manifold_.at(q, t);
    MatrixXd basis(static_cast<Index>(q.size()), 0);
    VectorXd of_basis(0);
    for (Index k = 0; k < values.g.size(); ++k) {
      VectorXd row = values.slopes.row(k);
      double g = values.g[k];
      const double size = row.norm();
      for (int pass = 0; pass < 2; ++pass) {
        const VectorXd parts = basis.transpose() * row;
        row -= basis * parts;
        g -= of_basis.dot(parts);
      }
      if (const double distance = size > 0 ? std::abs(g) / size : INFINITY; distance < missed_[k]) {
        missed_[k] = distance;
        differences_[k] = std::abs(g);
      }
      const double left = row.norm();
      if (!(left > dependence * size)) continue;
      found_[k] = 0;
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols(1) = row / left;
      of_basis.conservativeResize(basis.cols());
      of_basis[basis.cols() - 1] = g / left;
    }
  }

  const Manifold& manifold_;
  std::vector<char> found_, flat_;
  std::vector<double> missed_;       ///< distances from the surfaces
  std::vector<double> differences_;  ///< of both sides there
  std::vector<std::vector<double>> points_;
  std::vector<double> times_;
};

}  // namespace

void check_independent(const Scene& scene, const EndPoints& ends, const Problem& problem) {
  Dependence dependence(*problem.manifold);
  dependence.look_near(ends.start, 0);
  dependence.look_near(ends.end, problem.duration.value);
  std::vector<double> q(problem.coordinates());
  for (const double tau : {0.23, 0.48, 0.77}) {
    for (std::size_t a = 0; a < q.size(); ++a) q[a] = (1 - tau) * ends.start[a] + tau * ends.end[a];
    if (problem.guess.given()) problem.guess.at(tau, q);
    dependence.look_near(q, tau * problem.duration.value);
  }
  if (const int k = dependence.flat(); k >= 0) {
    const Text& text = scene.system.constraints[k];
    throw SceneError(
        position(text, 0),
        fmt::format("the gradient of the constraint '{}' vanishes where it holds, near the guess, "
                    "as that of a square does; write it without a power",
                    text.value));
  }
  const int k = dependence.first();
  if (k < 0) return;
  const Text& text = scene.system.constraints[k];
  const double missed = dependence.missed(k);
  throw SceneError(
      position(text, 0),
      !std::isfinite(missed)
          ? fmt::format("the gradient of the constraint '{}' is made of those of the ones before it, or "
                        "vanishes, near the guess; give one near points where the constraints hold",
                        text.value)
      : missed > end_distance
          ? fmt::format(
                "the gradient of the constraint '{}' is made of those of the ones before it, or "
                "vanishes, but where these hold it is missed by {:.3g}; leave it out, or give a guess "
                "where it is regular",
                text.value, dependence.difference(k))
      : dependence.missed_beside(k) > end_distance
          ? fmt::format("the constraint '{}' touches the ones before it: its gradient is made of theirs "
                        "wherever all hold, though it does not follow from them; give the points where all "
                        "hold by constraints with independent gradients",
                        text.value)
          : fmt::format("the constraint '{}' follows from the ones before it; leave it out", text.value));
}

}  // namespace extremal
