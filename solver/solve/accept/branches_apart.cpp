#include "solve/accept/branches_apart.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "problem/manifold.hpp"
#include "solve/accept/limits.hpp"

namespace extremal {

namespace {

namespace curve = limits::branches;
using Eigen::VectorXd;

enum class Met { end, start, far, unknown };

/// A curve g(q) = 0 from a point on it, by steps along its tangent that are projected back.
class Curve {
 public:
  Curve(const Manifold& manifold, VectorXd start, VectorXd end)
      : manifold_(manifold), start_(std::move(start)), end_(std::move(end)), size_((end_ - start_).norm()) {}

  Met follow(bool backwards) {
    VectorXd q = start_, t = tangent(q);
    if (t.size() == 0) return Met::unknown;
    if (backwards) t = -t;
    const VectorXd first = t;
    double step = curve::first_step * size_, length = 0;
    for (int k = 0; k < curve::most_steps; ++k) {
      VectorXd next = q + step * t;
      const bool on = manifold_.project({next.data(), static_cast<std::size_t>(next.size())}, 0);
      VectorXd turned = on ? tangent(next) : VectorXd();
      if (on && turned.size() == 0) return Met::unknown;  // branches cross there, or end
      if (on && turned.dot(t) < 0) turned = -turned;
      if (!on || turned.dot(t) < curve::least_cosine || (next - q).norm() > 2 * step) {
        if ((step /= 2) < curve::least_step * size_) return Met::unknown;
        continue;
      }
      if (passes(end_, q, next, curve::beside)) return Met::end;
      if (k > 0 && length > 2 * step && turned.dot(first) > 0 && passes(start_, q, next, curve::bulge))
        return Met::start;
      length += step;
      if ((next - start_).norm() > curve::far * size_) return Met::far;
      q = next;
      t = turned;
      if (turned.dot(t) > curve::quiet_cosine)
        step = std::min(1.5 * step, curve::longest_step * std::max(size_, (q - end_).norm()));
    }
    return Met::unknown;
  }

 private:
  /// Of unit size, across the rows of G; empty where they depend on each other.
  VectorXd tangent(const VectorXd& q) const {
    const ConstraintValues values = manifold_.at({q.data(), static_cast<std::size_t>(q.size())}, 0);
    if (!values.slopes.allFinite() || !manifold_.regular({q.data(), static_cast<std::size_t>(q.size())}, 0))
      return {};
    Eigen::FullPivLU<Eigen::MatrixXd> lu(values.slopes);
    if (lu.dimensionOfKernel() != 1) return {};
    return lu.kernel().col(0).normalized();
  }
  /// Whether a point lies between two that are near each other on a curve, or beside it by this part of their
  /// distance.
  static bool passes(const VectorXd& point, const VectorXd& a, const VectorXd& b, double within) {
    const VectorXd chord = b - a, from = point - a;
    const double along = from.dot(chord) / chord.squaredNorm();
    return along > -0.1 && along < 1.1 && (from - along * chord).norm() < within * chord.norm();
  }

  const Manifold& manifold_;
  VectorXd start_, end_;
  double size_;
};

}  // namespace

std::string branches_apart(const Problem& problem) {
  if (!problem.manifold || problem.periodic || !problem.manifold->autonomous()) return {};
  const int n = problem.manifold->coordinates();
  if (n - problem.manifold->constraints() != 1 || problem.coordinates() != n) return {};
  if (std::ranges::count(problem.ends.fixed, 0) > 0) return {};
  const Eigen::Map<const VectorXd> ends(problem.ends.offset.data(), 2L * n);
  const VectorXd start = ends.head(n), end = ends.tail(n);
  if (!((end - start).norm() > 0)) return {};
  Curve way(*problem.manifold, start, end);
  for (const bool backwards : {false, true}) {
    const Met met = way.follow(backwards);
    if (met == Met::end || met == Met::unknown) return {};
    if (met == Met::start) break;
  }
  return "the constraints leave a curve, and the part of it on which the start lies does not lead to the "
         "end: move an end";
}

}  // namespace extremal
