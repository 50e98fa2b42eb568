#include "solve/contact/tight_path.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "problem/manifold.hpp"
#include "problem/point_range.hpp"
#include "solve/contact/aside.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// L and its derivatives at the middle of element k.
PointValues at_middle(const Problem& problem, const CoarseAction& action, const std::vector<double>& z, int k,
                      Order order, Scratch& scratch) {
  const auto n = static_cast<std::size_t>(action.coordinates());
  std::vector<double> q(n), v(n);
  for (std::size_t a = 0; a < n; ++a) {
    q[a] = (z[k * n + a] + z[(k + 1) * n + a]) / 2;
    v[a] = (z[(k + 1) * n + a] - z[k * n + a]) / action.length(k);
  }
  return evaluate_at(*problem.lagrangian, q, v, (action.time(k) + action.time(k + 1)) / 2, order, scratch);
}

double action_of(const Problem& problem, const CoarseAction& action, const std::vector<double>& z,
                 Scratch& scratch) {
  double sum = 0;
  for (int k = 0; k < action.elements(); ++k)
    sum += action.length(k) * at_middle(problem, action, z, k, Order::value, scratch).value;
  return sum;
}

}  // namespace

bool push_node(const Problem& problem, std::span<double> q, double t) {
  const Inequalities& inequalities = *problem.inequalities;
  for (int pass = 0; pass < most_pushes; ++pass) {
    const ConstraintValues values = inequalities.all->at(q, t);
    Eigen::Index worst = 0;
    const double least = values.g.minCoeff(&worst);
    if (least >= 0) return true;
    const VectorXd slope = values.slopes.row(worst), across = inequalities.all->metric() * slope;
    const double square = slope.dot(across);
    if (!(square > 0)) return false;
    // A step slightly beyond, so that rounding does not keep the node outside.
    const VectorXd step = -(1 + 1e-6) * least / square * across;
    for (std::size_t a = 0; a < q.size(); ++a) q[a] += step[a];
    if (problem.manifold && !problem.manifold->project(q, t)) return false;
  }
  return false;
}

std::optional<TightPath> pulled_tight(const Problem& problem, const CoarseAction& action,
                                      std::vector<double> z) {
  const auto n = static_cast<std::size_t>(action.coordinates());
  const int last = action.elements();
  Scratch scratch;
  std::vector<MatrixXd> masses;
  for (int k = 0; k < last; ++k) {
    const PointValues values = at_middle(problem, action, z, k, Order::hessian, scratch);
    masses.push_back(Eigen::Map<const RowMajor>(values.vv.data(), n, n) / action.length(k));
  }
  std::vector<Eigen::LLT<MatrixXd>> stiffness;
  for (int k = 1; k < last; ++k) {
    stiffness.emplace_back(masses[k - 1] + masses[k]);
    if (stiffness.back().info() != Eigen::Success) return std::nullopt;
  }
  const double before = action_of(problem, action, z, scratch), size = largest_range(z, n);
  const double swiftest = 2 / (1 + std::sin(std::numbers::pi / last));
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const double relaxation = sweep + plain_sweeps < most_sweeps ? swiftest : 1;
    double longest = 0;
    for (int k = 1; k < last; ++k) {
      const PointValues left = at_middle(problem, action, z, k - 1, Order::gradient, scratch),
                        right = at_middle(problem, action, z, k, Order::gradient, scratch);
      VectorXd force(n);
      for (std::size_t a = 0; a < n; ++a)
        force[a] = right.dv[a] - left.dv[a] -
                   (action.length(k - 1) * left.dq[a] + action.length(k) * right.dq[a]) / 2;
      VectorXd step = relaxation * stiffness[k - 1].solve(force);
      if (!step.allFinite()) return std::nullopt;
      step *= std::min(1.0, size / last / std::max(step.norm(), 1e-300));
      const std::span<double> q(z.data() + k * n, n);
      const std::vector<double> from(q.begin(), q.end());
      for (std::size_t a = 0; a < n; ++a) q[a] += step[a];
      if (!push_node(problem, q, action.time(k))) return std::nullopt;
      for (std::size_t a = 0; a < n; ++a) longest = std::max(longest, std::abs(q[a] - from[a]));
    }
    if (longest <= tight * size) break;
  }
  const double after = action_of(problem, action, z, scratch);
  if (!(after <= before) || cuts_through(problem, action, z)) return std::nullopt;
  return TightPath{after, std::move(z)};
}

}  // namespace extremal
