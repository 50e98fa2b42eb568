#include "linear/border.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "machine/roundoff.hpp"

namespace extremal {

namespace {

/// Parts this much larger than the solution they add up to cost digits that refinement brings back.
constexpr double cancellation = 4;
/// Smaller singular values are roundoff.
constexpr double least_value = 64 * machine_epsilon;
/// A right side that has no more than this part along a left null vector is met.
constexpr double met = 1e-6;

}  // namespace

void Border::resize(int order, int columns, bool symmetric) {
  if (order < 0 || columns < 0)
    throw std::invalid_argument(
        fmt::format("border: {} columns of {} rows; need at least 0", columns, order));
  order_ = order;
  columns_ = columns;
  symmetric_ = symmetric;
  finite_ = regular_ = false;
  c_.resize(std::size_t(order) * columns);
  if (!symmetric) r_.resize(c_.size());
  d_.resize(std::size_t(columns) * columns);
}

double* Border::row_block() {
  if (symmetric_) throw std::logic_error("border: a symmetric border has no rows of its own");
  return r_.data();
}

Eigen::Map<const Border::RowMatrix> Border::block(const std::vector<double>& data) const {
  return {data.data(), order_, columns_};
}

/// w := A'⁻¹ [data E].
void Border::extend(const Chain& a, const std::vector<double>& data, RowMatrix& w) const {
  w.setZero(order_, extended_);
  w.leftCols(columns_) = block(data);
  for (int e = columns_; e < extended_; ++e) w(a.deflated()[e - columns_].row, e) = 1;
  a.solve(w.data(), extended_);
}

/// S, and beside every difference the size of its terms.
void Border::form_schur(const Chain& a) {
  const Eigen::Map<const RowMatrix> r = block(rows());
  const Eigen::Map<const RowMatrix> d(d_.data(), columns_, columns_);
  schur_.setZero(extended_, extended_);
  unit_.setZero(extended_);
  schur_.topLeftCorner(columns_, columns_) = d;
  for (int i = 0; i < columns_; ++i) unit_[i] = std::abs(d(i, i));
  for (int k = 0; k < order_; ++k)
    for (int i = 0; i < columns_; ++i) {
      for (int j = 0; j < extended_; ++j) schur_(i, j) -= r(k, i) * w_(k, j);
      unit_[i] += std::abs(r(k, i) * w_(k, i));
    }
  for (int e = columns_; e < extended_; ++e) {
    const Deflation& deflation = a.deflated()[e - columns_];
    for (int j = 0; j < extended_; ++j) schur_(e, j) = -w_(deflation.row, j);
    schur_(e, e) += 1 / deflation.amount;
    unit_[e] = 1 / deflation.amount + std::abs(w_(deflation.row, e));
  }
  for (int i = 0; i < extended_; ++i) {
    if (unit_[i] == 0) unit_[i] = schur_.row(i).lpNorm<Eigen::Infinity>();
    unit_[i] = unit_[i] > 0 ? std::sqrt(unit_[i]) : 1;
  }
  schur_.array().colwise() /= unit_.array();
  schur_.array().rowwise() /= unit_.transpose().array();
}

bool Border::factor(Chain& a, double deflated) {
  finite_ = regular_ = false;
  if (a.order() != order_)
    throw std::invalid_argument(fmt::format("border: {} rows around a chain of {}", order_, a.order()));
  if (!a.factor(deflated) && a.deflated().empty()) return false;
  chain_inertia_ = a.inertia();
  chain_inertia_.positive += chain_inertia_.zero;
  chain_inertia_.zero = 0;
  extended_ = columns_ + int(a.deflated().size());
  if (extended_ == 0) return finite_ = regular_ = true;
  extend(a, c_, w_);
  form_schur(a);
  finite_ = schur_.allFinite();
  if (!finite_) return false;
  lu_.compute(schur_);
  const double smallest = lu_.matrixLU().diagonal().cwiseAbs().minCoeff();
  return regular_ = smallest > 64 * machine_epsilon * std::sqrt(double(order()));
}

/// Block elimination in place, given how to solve with the scaled S. Returns how much larger A'⁻¹ b was
/// than the solution.
template <class Solve>
double Border::eliminate(const Chain& a, double* x, int columns, const Solve& solve_schur) const {
  Eigen::Map<RowMatrix> top(x, order_, columns), bottom(x + std::size_t(order_) * columns, columns_, columns);
  a.solve(x, columns);
  const double before = order_ > 0 ? top.lpNorm<Eigen::Infinity>() : 0.0;
  small_.resize(extended_, columns);
  small_.topRows(columns_).noalias() = bottom - block(rows()).transpose() * top;
  for (int e = columns_; e < extended_; ++e) small_.row(e) = -top.row(a.deflated()[e - columns_].row);
  small_.array().colwise() /= unit_.array();
  solve_schur(small_, border_);
  border_.array().colwise() /= unit_.array();
  top.noalias() -= w_ * border_;
  bottom = border_.topRows(columns_);
  const double after = order_ > 0 ? top.lpNorm<Eigen::Infinity>() : 0.0;
  return before > cancellation * after ? before : 0;
}

/// r := b − K x.
void Border::residual(const Chain& a, const double* x, const double* b, double* r, int columns) const {
  const Eigen::Map<const RowMatrix> top(x, order_, columns),
      bottom(x + std::size_t(order_) * columns, columns_, columns), right(b, order(), columns),
      d(d_.data(), columns_, columns_);
  Eigen::Map<RowMatrix> result(r, order(), columns);
  a.multiply(x, r, columns);
  result.topRows(order_) += block(c_) * bottom;
  result.bottomRows(columns_).noalias() = block(rows()).transpose() * top;
  result.bottomRows(columns_) += d * bottom;
  result = right - result;
}

void Border::solve(const Chain& a, double* x, int columns) const {
  if (!regular_) throw std::logic_error("border: solve without a regular factorisation");
  if (columns < 1) return;
  if (extended_ == 0) return a.solve(x, columns);
  const auto with_lu = [&](const RowMatrix& b, RowMatrix& y) { y = lu_.solve(b); };
  Eigen::Map<RowMatrix> solution(x, order(), columns);
  right_ = solution;
  const bool lost = eliminate(a, x, columns, with_lu) > 0;
  if (!lost && extended_ == columns_) return;
  const int steps = 2;
  for (int step = 0; step < steps; ++step) {
    first_.resize(order(), columns);
    residual(a, x, right_.data(), first_.data(), columns);
    eliminate(a, first_.data(), columns, with_lu);
    solution += first_;
  }
}

int Border::solve_least_norm(const Chain& a, double* x, int columns, double threshold) const {
  if (!finite_) throw std::logic_error("border: solve without a factorisation of finite blocks");
  if (columns < 1 || order() == 0) return 0;
  if (extended_ == 0) return a.solve(x, columns), 0;
  const SingularValues svd = singular_value_decomposition(schur_);
  const Eigen::VectorXd& values = svd.values;
  const int rank = int((values.array() > std::max(threshold, least_value)).count()), null = extended_ - rank;
  // Null vectors of the whole: x = −A'⁻¹ [C E] y for y in the null space of S; on the left likewise.
  const auto whole = [&](const RowMatrix& w, const Eigen::MatrixXd& vectors) {
    const Eigen::MatrixXd y = unit_.cwiseInverse().asDiagonal() * vectors.rightCols(null);
    Eigen::MatrixXd v(order(), null);
    v.topRows(order_).noalias() = -(w * y);
    v.bottomRows(columns_) = y.topRows(columns_);
    return orthonormal(v);
  };
  const Eigen::MatrixXd right = whole(w_, svd.v);
  RowMatrix w = w_;
  if (!symmetric_) extend(a, r_, w);
  const Eigen::MatrixXd left = whole(w, svd.u);
  const auto with_svd = [&](const RowMatrix& b, RowMatrix& y) {
    const Eigen::MatrixXd part = svd.u.leftCols(rank).transpose() * b;
    y = svd.v.leftCols(rank) * (values.head(rank).cwiseInverse().asDiagonal() * part);
  };
  Eigen::Map<RowMatrix> solution(x, order(), columns);
  const auto project = [](auto&& vectors, const Eigen::MatrixXd& out) {
    vectors -= out * (out.transpose() * vectors).eval();
  };
  if (threshold == 0 && null == 1 && (left.transpose() * solution).norm() > met * solution.norm()) {
    eliminate(a, x, columns, [&](const RowMatrix& b, RowMatrix& y) {
      y = svd.v * (values.cwiseMax(least_value).cwiseInverse().asDiagonal() * (svd.u.transpose() * b));
    });
    return 0;
  }
  project(solution, left);
  RowMatrix b = solution;
  eliminate(a, x, columns, with_svd);
  first_.resize(order(), columns);
  residual(a, x, b.data(), first_.data(), columns);
  project(first_, left);
  eliminate(a, first_.data(), columns, with_svd);
  solution += first_;
  project(solution, right);
  return null;
}

Inertia Border::inertia(double threshold) const {
  if (!finite_) throw std::logic_error("border: inertia without a factorisation of finite blocks");
  if (!symmetric_) throw std::logic_error("border: an unsymmetric border has no inertia");
  Inertia result = chain_inertia_;
  if (extended_ == 0) return result;
  const double zero = std::max(threshold, 64 * machine_epsilon * std::sqrt(double(order())));
  const Eigen::MatrixXd s = (schur_ + schur_.transpose()) / 2;
  const Eigen::VectorXd values = symmetric_eigenvalues(s);
  for (double v : values) ++(v > zero ? result.positive : v < -zero ? result.negative : result.zero);
  result.positive -= extended_ - columns_;
  return result;
}

Eigen::VectorXd Border::singular_values() const {
  if (!finite_ || extended_ == 0) return {};
  return extremal::singular_values(schur_);
}

double Border::smallest_singular_value() const {
  const Eigen::VectorXd values = singular_values();
  return values.size() == 0 ? std::numeric_limits<double>::infinity() : values.minCoeff();
}

double Border::condition() const {
  const Eigen::VectorXd values = singular_values();
  return values.size() == 0 ? 1.0 : values.maxCoeff() / values.minCoeff();
}

}  // namespace extremal
