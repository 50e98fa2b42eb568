#include "solve/contact/coarse_action.hpp"

#include <algorithm>
#include <cmath>

#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/element_hessian.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Square = Eigen::Map<const RowMajor>;

/// The part of a matrix of so many rows that belongs to the first n coordinates.
void cut(std::vector<double>& matrix, int rows, int n) {
  const RowMajor part = Square(matrix.data(), rows, rows).topLeftCorner(n, n);
  matrix.assign(part.data(), part.data() + part.size());
}

}  // namespace

CoarseAction::CoarseAction(const Problem& problem, const CoarseElements& elements)
    : CoarseAction(problem, coarse_times(problem, elements)) {}

CoarseAction::CoarseAction(const Problem& problem, std::vector<double> times)
    : problem_(problem),
      inequalities_(*problem.inequalities),
      n_(problem.coordinates()),
      elements_(static_cast<int>(times.size()) - 1),
      times_(std::move(times)) {
  put_waypoints();
  for (int k = 0; k <= elements_; ++k) {
    // The end of a closed path is its start.
    if (fixed(k) || (problem.periodic && k == elements_)) continue;
    for (int c = 0; c < inequalities_.count(); ++c) places_.push_back({k, c});
    if (problem.manifold) constrained_.push_back(k);
  }
}

double CoarseAction::elements_in(double from, double to) const {
  const auto place = [&](double t) {
    const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
    return static_cast<double>(after - times_.begin()) - (*after - t) / (*after - *(after - 1));
  };
  return place(to) - place(from);
}

bool CoarseAction::fixed(int node) const {
  if (std::ranges::count(waypoints_, node, &FixedCoordinate::node) == n_) return true;
  return (node == 0 || node == elements_) && problem_.ends.fixes(node != 0);
}

void CoarseAction::midpoint(std::span<const double> z, int k, Point& point) const {
  const double *a = z.data() + k * n_, *b = a + n_;
  point.q.resize(n_);
  point.v.resize(n_);
  for (int i = 0; i < n_; ++i) {
    point.q[i] = 0.5 * (a[i] + b[i]);
    point.v[i] = (b[i] - a[i]) / length(k);
  }
}

PointValues CoarseAction::values(std::span<const double> z, int k, Order order,
                                 std::span<const double> nu) const {
  Point point;
  Scratch scratch;
  midpoint(z, k, point);
  const std::vector<double> constants = this->constants(nu);
  point.q.insert(point.q.end(), constants.begin(), constants.end());
  point.v.resize(point.q.size(), 0);
  const Lagrangian& lagrangian = constants.empty() ? *problem_.lagrangian : *problem_.extension->lagrangian;
  return evaluate_at(lagrangian, point.q, point.v, (times_[k] + times_[k + 1]) / 2, order, scratch);
}

std::vector<double> CoarseAction::constants(std::span<const double> nu) const {
  if (!problem_.extension) return {};
  std::vector<double> constants = problem_.extension->guess;
  constants.insert(constants.end(), nu.begin(), nu.end());
  return constants;
}

PointValues CoarseAction::weighted(std::span<const double> z, int k, Order order, double factor,
                                   std::span<const double> nu) const {
  PointValues sum = values(z, k, order, nu);
  const PointValues law = factor == 1 ? PointValues{} : values(z, k, order);
  const auto add = [&](std::vector<double>& to, const std::vector<double>& from) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] += (factor - 1) * from[i];
  };
  sum.value += (factor - 1) * law.value;
  add(sum.dq, law.dq);
  add(sum.dv, law.dv);
  add(sum.qq, law.qq);
  add(sum.vq, law.vq);
  add(sum.vv, law.vv);
  sum.dq.resize(n_);
  sum.dv.resize(n_);
  const int all = first_multiplier() + static_cast<int>(nu.size());
  for (std::vector<double>* matrix : {&sum.qq, &sum.vq, &sum.vv})
    if (!matrix->empty()) cut(*matrix, all, n_);
  return sum;
}

std::vector<double> CoarseAction::integral_values(std::span<const double> z) const {
  std::vector<double> sums(integrals());
  if (sums.empty()) return sums;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    for (std::size_t j = 0; j < sums.size(); ++j) sums[j] += length(k) * l.dq[first_multiplier() + j];
  }
  return sums;
}

/// ∂∫g/∂z, a row of each.
MatrixXd CoarseAction::integral_slopes(std::span<const double> z) const {
  const int m = integrals(), all = first_multiplier() + m;
  MatrixXd rows = MatrixXd::Zero(m, static_cast<Index>(z.size()));
  for (int k = 0; k < elements_ && m > 0; ++k) {
    const PointValues l = values(z, k, Order::hessian);
    const Square qq(l.qq.data(), all, all), vq(l.vq.data(), all, all);
    const MatrixXd by_q = 0.5 * length(k) * qq.bottomLeftCorner(m, n_),
                   by_v = vq.topRightCorner(n_, m).transpose();
    rows.middleCols(k * n_, n_) += by_q - by_v;
    rows.middleCols((k + 1) * n_, n_) += by_q + by_v;
  }
  return rows;
}

std::vector<double> CoarseAction::integral_multipliers(const MinimumReport& report) const {
  const auto first = report.of_equations.begin() + linear_equations();
  return {first, first + integrals()};
}

ConstraintValues CoarseAction::at(const Manifold& manifold, std::span<const double> z, int node) const {
  return manifold.at(z.subspan(node * n_, n_), time(node));
}

MatrixXd CoarseAction::curvature(const Manifold& manifold, std::span<const double> z, int node,
                                 std::span<const double> multipliers) const {
  const int all = n_ + 1 + static_cast<int>(multipliers.size());
  std::vector<double> point(z.begin() + node * n_, z.begin() + (node + 1) * n_), rest(all);
  point.push_back(time(node));
  point.insert(point.end(), multipliers.begin(), multipliers.end());
  Scratch scratch;
  const PointValues form = evaluate_at(*manifold.parts().forms, point, rest, 0, Order::hessian, scratch);
  return Square(form.qq.data(), all, all).topLeftCorner(n_, n_);
}

std::vector<double> CoarseAction::ends(std::span<const double> z) const {
  std::vector<double> ends(z.begin(), z.begin() + n_);
  ends.insert(ends.end(), z.begin() + variable(n_), z.begin() + variable(2 * n_));
  return ends;
}

double CoarseAction::closing(std::span<const double> z, std::span<const double> nu) const {
  if (closed_by_condition(problem_)) {
    std::vector<double> gradient(2 * static_cast<std::size_t>(n_));
    return closing_condition(problem_, constants(std::vector<double>(integrals())), ends(z), gradient);
  }
  double energy = 0;
  const int first = waypoints_.empty() ? 0 : waypoints_.back().node;
  const double length = times_.back() - times_[first];
  for (int k = first; k < elements_; ++k) {
    const PointValues l = weighted(z, k, Order::gradient, 1, nu);
    double action = 0;  // p·q'
    for (int a = 0; a < n_; ++a) action += l.dv[a] * (z[(k + 1) * n_ + a] - z[k * n_ + a]);
    energy += (action - this->length(k) * l.value) / length;
  }
  return energy - *problem_.duration.energy;
}

std::vector<double> CoarseAction::where(std::span<const double> z) const {
  std::vector<double> missed, gradient(2 * static_cast<std::size_t>(n_));
  const std::vector<double> constants = this->constants(std::vector<double>(integrals()));
  for (std::size_t i = first_where(problem_); problem_.extension && i < problem_.extension->where.size(); ++i)
    missed.push_back(condition_at(problem_.extension->where[i], constants, ends(z), gradient, {}));
  return missed;
}

double CoarseAction::force(std::span<const double> z) const {
  double largest = 0;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    for (int a = 0; a < n_; ++a)
      largest = std::max({largest, std::abs(l.dq[a]), std::abs(l.dv[a]) / problem_.duration.value});
  }
  return largest;
}

}  // namespace extremal
