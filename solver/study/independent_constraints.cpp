#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints.hpp"
#include "study/limits.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Which constraints have gradients that are made of those before them, as points are looked at.
class Dependence {
 public:
  explicit Dependence(const Manifold& manifold)
      : manifold_(manifold), found_(manifold.constraints(), 1), missed_(manifold.constraints(), INFINITY) {}

  /// At a point, on the manifold if it can be moved there.
  void look_near(const std::vector<double>& q, double t) {
    std::vector<double> moved = q;
    look(manifold_.project(moved, t) ? moved : q, t);
  }

  /// The first that depends on others at all points, or -1.
  int first() const {
    const auto found = std::ranges::find(found_, 1);
    return found == found_.end() ? -1 : static_cast<int>(found - found_.begin());
  }
  /// By how much it is missed at the least, in units of q.
  double missed(int k) const { return missed_[k]; }

 private:
  void look(const std::vector<double>& q, double t) {
    const ConstraintValues values = manifold_.at(q, t);
    MatrixXd basis(static_cast<Index>(q.size()), 0);
    for (Index k = 0; k < values.g.size(); ++k) {
      VectorXd row = values.slopes.row(k);
      const double size = row.norm();
      for (int pass = 0; pass < 2; ++pass) row -= basis * (basis.transpose() * row).eval();
      missed_[k] = std::min(missed_[k], size > 0 ? std::abs(values.g[k]) / size : INFINITY);
      if (!(row.norm() > dependence * size)) continue;
      found_[k] = 0;
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols(1) = row.normalized();
    }
  }

  const Manifold& manifold_;
  std::vector<char> found_;
  std::vector<double> missed_;
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
  const int k = dependence.first();
  if (k < 0) return;
  const Text& text = scene.system.constraints[k];
  throw SceneError(
      position(text, 0),
      dependence.missed(k) <= end_distance
          ? fmt::format("the constraint '{}' follows from the ones before it; leave it out", text.value)
          : fmt::format("the gradient of the constraint '{}' is made of those of the ones before "
                        "it, or vanishes, but where these hold it is missed by {:.3g}; leave it "
                        "out, or give a guess where it is regular",
                        text.value, dependence.missed(k)));
}

}  // namespace extremal
