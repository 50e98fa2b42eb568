#include "problem/manifold.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "machine/roundoff.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_steps = 60;
constexpr double least_factor = 1e-3;
/// Steps below so many roundings of the point gain nothing more.
constexpr double last_step = 4 * machine_epsilon;
/// Where g cannot be made smaller, so long a step was one of roundoff.
constexpr double rounded_step = 1e3 * last_step;

/// Singular values of gradients of unit length that depend on each other.
constexpr double dependence = 1e-9;

/// A point with t, and multipliers zero but for one.
std::vector<double> extended(std::span<const double> q, double t, int further, int one = -1) {
  std::vector<double> point(q.begin(), q.end());
  point.push_back(t);
  point.resize(point.size() + further);
  if (one >= 0) point[q.size() + 1 + one] = 1;
  return point;
}

Eigen::Map<const MatrixXd> square(const std::vector<double>& entries, Index n) {
  return {entries.data(), n, n};
}

Eigen::Map<const VectorXd> vector(std::span<const double> values) {
  return {values.data(), static_cast<Index>(values.size())};
}

std::vector<double> values_of(const VectorXd& vector) { return {vector.begin(), vector.end()}; }

}  // namespace

bool Manifold::autonomous() const {
  if (!parts_.lagrangian->structure().autonomous) return false;
  const auto reads_time = [n = coordinates()](int z) { return z == n; };
  return std::ranges::none_of(parts_.forms->structure().gradient, reads_time);
}

ConstraintValues Manifold::at(std::span<const double> q, double t) const {
  const Index n = coordinates(), m = constraints(), all = n + 1 + m;
  const std::vector<double> point = extended(q, t, static_cast<int>(m)), rest(all);
  Scratch scratch;
  const PointValues values = evaluate_at(*parts_.forms, point, rest, 0, Order::hessian, scratch);
  const auto hessian = square(values.qq, all);
  return {vector(values.dq).tail(m), hessian.block(n + 1, 0, m, n), hessian.block(n + 1, n, m, 1)};
}

/// W Gᵀ A⁻¹ g, the shortest where gradients depend on each other.
VectorXd Manifold::normal_step(const ConstraintValues& values, const VectorXd& g) const {
  const MatrixXd across = parts_.metric * values.slopes.transpose();
  const MatrixXd a = values.slopes * across;
  return across * least_norm(a, g);
}

/// The step of one iteration onto the manifold from q; infinite where gradients vanish or depend on each
/// other so that none leads nearer, by more than the last digits of q are.
VectorXd Manifold::step_onto(std::span<const double> q, const ConstraintValues& values) const {
  const VectorXd step = normal_step(values, values.g);
  const double left = (values.g - values.slopes * step).norm();
  const double digits = rounded_step * values.slopes.norm() * vector(q).norm();
  if (left <= std::max(0.5 * values.g.norm(), digits)) return step;
  return VectorXd::Constant(step.size(), INFINITY);
}

bool Manifold::regular(std::span<const double> q, double t) const {
  MatrixXd slopes = at(q, t).slopes;
  for (auto row : slopes.rowwise()) row.normalize();  // leaves zero as it is
  const VectorXd values = singular_values(slopes);
  return values[constraints() - 1] > dependence * values[0];
}

double Manifold::radius(std::span<const double> q, double t) const {
  const Index n = coordinates(), m = constraints(), all = n + 1 + m;
  const std::vector<double> rest(all);
  Scratch scratch;
  double largest = 0;
  for (Index k = 0; k < m; ++k) {
    const std::vector<double> point = extended(q, t, static_cast<int>(m), static_cast<int>(k));
    const PointValues values = evaluate_at(*parts_.forms, point, rest, 0, Order::hessian, scratch);
    const double bend = square(values.qq, all).topLeftCorner(n, n).norm(),
                 slope = vector(values.dq).head(n).norm();
    if (bend > 0 && std::isfinite(slope / bend)) largest = std::max(largest, slope / bend);
  }
  return largest;
}

bool Manifold::project(std::span<double> q, double t) const {
  Eigen::Map<VectorXd> point(q.data(), static_cast<Index>(q.size()));
  ConstraintValues values = at(q, t);
  for (int k = 0; k < most_steps && !values.g.isZero(0); ++k) {
    const VectorXd from = point, step = step_onto(q, values);
    const double length = step.norm(), before = values.g.norm();
    if (!std::isfinite(length)) return false;
    bool nearer = false;
    for (double factor = 1; factor > least_factor && !nearer; factor /= 2) {
      point = from - factor * step;
      const ConstraintValues there = at(q, t);
      nearer = there.g.norm() < before;
      if (nearer) values = there;
    }
    if (!nearer) {
      point = from;
      return length <= rounded_step * std::max(point.norm(), radius(q, t));
    }
    if (length <= last_step * point.norm()) return true;
  }
  return values.g.isZero(0);
}

void Manifold::make_tangent(std::span<const double> q, double t, std::span<double> v) const {
  Eigen::Map<VectorXd> velocity(v.data(), static_cast<Index>(v.size()));
  const ConstraintValues values = at(q, t);
  for (int pass = 0; pass < 2; ++pass)
    velocity -= normal_step(values, values.slopes * velocity + values.rates);
}

double Manifold::distance(std::span<const double> q, double t) const {
  const ConstraintValues values = at(q, t);
  return step_onto(q, values).norm();
}

std::vector<double> Manifold::projected_momentum(std::span<const double> q, double t,
                                                 std::span<const double> p) const {
  const ConstraintValues values = at(q, t);
  const MatrixXd across = parts_.metric * values.slopes.transpose();
  const MatrixXd a = values.slopes * across;
  const VectorXd normal = least_norm(a, across.transpose() * vector(p));
  return values_of(vector(p) - values.slopes.transpose() * normal);
}

namespace {

/// (x, λ) of M x − Gᵀ λ = a, G x = b. M and the rows of G, whose units differ, are divided by their sizes.
struct SaddlePoint {
  VectorXd x, multipliers;
};

SaddlePoint saddle_point(const MatrixXd& mass, const MatrixXd& slopes, const VectorXd& a, const VectorXd& b) {
  const Index n = mass.rows(), m = slopes.rows();
  const auto unit = [](double size) { return size > 0 ? size : 1; };
  const double heavy = unit(mass.lpNorm<Eigen::Infinity>());
  VectorXd steep(m);
  for (Index k = 0; k < m; ++k) steep[k] = unit(slopes.row(k).norm());
  const MatrixXd scaled = steep.cwiseInverse().asDiagonal() * slopes;
  MatrixXd matrix(n + m, n + m);
  matrix << mass / heavy, -scaled.transpose(), scaled, MatrixXd::Zero(m, m);
  VectorXd right(n + m);
  right << a / heavy, b.cwiseQuotient(steep);
  const VectorXd found = least_norm(matrix, right);
  return {found.head(n), heavy * found.tail(m).cwiseQuotient(steep)};
}

}  // namespace

/// Newton's method for L_v(v) = projection + Gᵀ μ, G v + ∂g/∂t = 0.
std::vector<double> Manifold::momentum(std::span<const double> q, double t,
                                       std::span<const double> projection, std::span<double> v) const {
  constexpr int most = 20;
  const Index n = coordinates();
  const ConstraintValues values = at(q, t);
  Eigen::Map<VectorXd> velocity(v.data(), n);
  Scratch scratch;
  double before = INFINITY;
  for (int k = 0; k < most; ++k) {
    const PointValues l = evaluate_at(*parts_.lagrangian, q, v, t, Order::hessian, scratch);
    const VectorXd step = saddle_point(square(l.vv, n), values.slopes, vector(projection) - vector(l.dv),
                                       -(values.slopes * velocity + values.rates))
                              .x;
    const double length = step.norm();
    if (!(length < before)) break;
    velocity += step;
    before = length;
    if (length <= last_step * velocity.norm()) break;
  }
  return momentum(q, t, v);
}

std::vector<double> Manifold::momentum(std::span<const double> q, double t, std::span<const double> v) const {
  Scratch scratch;
  return evaluate_at(*parts_.lagrangian, q, v, t, Order::gradient, scratch).dv;
}

double Manifold::energy(std::span<const double> q, double t, std::span<const double> v) const {
  Scratch scratch;
  const PointValues l = evaluate_at(*parts_.lagrangian, q, v, t, Order::gradient, scratch);
  return vector(l.dv).dot(vector(v)) - l.value;
}

/// ∂L/∂q + F: what two copies that agree have by the first of them.
VectorXd Manifold::force(std::span<const double> q, double t, std::span<const double> v) const {
  const Lagrangian& lagrangian = parts_.copies ? *parts_.copies : *parts_.lagrangian;
  std::vector<double> both_q(q.begin(), q.end()), both_v(v.begin(), v.end());
  if (parts_.copies) {
    both_q.insert(both_q.end(), q.begin(), q.end());
    both_v.insert(both_v.end(), v.begin(), v.end());
  }
  Scratch scratch;
  return vector(evaluate_at(lagrangian, both_q, both_v, t, Order::gradient, scratch).dq).head(coordinates());
}

/// M q'' − Gᵀ λ = L_q + F − L_vq q' − L_vt and G q'' = −(second derivative of g along the motion without
/// q'').
std::vector<double> Manifold::multipliers(std::span<const double> q, double t,
                                          std::span<const double> v) const {
  const Index n = coordinates(), m = constraints(), all = n + 1 + m;
  const std::vector<double> rest(all), state = extended(q, t, 0);
  const std::vector<double> motion = extended(v, 1, 0);
  const ConstraintValues values = at(q, t);
  Scratch scratch;
  const PointValues l = evaluate_at(*parts_.timed, state, motion, 0, Order::hessian, scratch);
  // Of (q', q), row-major.
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> vq(
      l.vq.data(), n + 1, n + 1);
  const VectorXd acting = force(q, t, v) - (vq * vector(motion)).head(n);
  VectorXd curvature(m);
  for (Index k = 0; k < m; ++k) {
    const std::vector<double> point = extended(q, t, static_cast<int>(m), static_cast<int>(k));
    const PointValues form = evaluate_at(*parts_.forms, point, rest, 0, Order::hessian, scratch);
    const MatrixXd second = square(form.qq, all).topLeftCorner(n + 1, n + 1);
    curvature[k] = -vector(motion).dot(second * vector(motion));
  }
  return values_of(
      saddle_point(square(l.vv, n + 1).topLeftCorner(n, n), values.slopes, acting, curvature).multipliers);
}

}  // namespace extremal
