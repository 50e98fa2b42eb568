#include "solve/newton/sparse_border.hpp"
#include "solve/newton/limits.hpp"

#include <utility>

#include "linear/dense.hpp"

namespace extremal {

using namespace limits::sparse_border;

namespace {

Eigen::Map<const Eigen::VectorXd> vector(std::span<const double> x) { return {x.data(), std::ssize(x)}; }

}  // namespace

/// Unit vectors along which the directions are independent: the largest entry of each, the others eliminated.
void SparseBorder::hold(Eigen::MatrixXd directions) {
  directions_ = std::move(directions);
  for (auto direction : directions_.colwise()) direction.normalize();
  pinned_.assign(directions_.cols(), 0);
  Eigen::MatrixXd rest = directions_;
  for (Eigen::Index j = 0; j < rest.cols(); ++j) {
    Eigen::Index row;
    const double pivot = rest.col(j).cwiseAbs().maxCoeff(&row);
    pinned_[j] = static_cast<int>(row);
    if (!(pivot > 0)) continue;
    for (Eigen::Index i = j + 1; i < rest.cols(); ++i)
      rest.col(i) -= rest(row, i) / rest(row, j) * rest.col(j);
  }
}

void SparseBorder::factor(SparseSymmetric& a, double kappa, std::span<const double> first) {
  kappa_ = kappa;
  first_ = first.empty() ? 0 : 1;
  const Eigen::Index rows = first_ > 0 ? std::ssize(first) : directions_.rows();
  solved_.setZero(rows, first_ + 2 * held());
  if (first_ > 0) solved_.col(0) = vector(first);
  solved_.middleCols(first_, held()) = directions_;
  for (int j = 0; j < held(); ++j) solved_(pinned_[j], first_ + held() + j) = 1;
  for (auto column : solved_.colwise()) a.solve(column.data(), 1);
}

Eigen::MatrixXd SparseBorder::schur(std::span<const double> row, double corner) const {
  const int h = held();
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(solved_.cols(), solved_.cols());
  if (first_ > 0) {
    s.row(0) = -vector(row).transpose() * solved_;
    s(0, 0) += corner;
  }
  s.middleRows(first_, h) = -directions_.transpose() * solved_;
  for (int j = 0; j < h; ++j) {
    s.row(first_ + h + j) = -solved_.row(pinned_[j]);
    s(first_ + h + j, first_ + h + j) += 1 / kappa_;
  }
  return s;
}

double SparseBorder::solve(SparseSymmetric& a, std::span<double> x, std::span<const double> row,
                           double corner, double value, bool refine) const {
  refine ? a.solve(x.data(), 1) : a.solve_step(x.data());
  if (solved_.cols() == 0) return 0;
  Eigen::MatrixXd s = schur(row, corner);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(s.rows());
  Eigen::Map<Eigen::VectorXd> all(x.data(), std::ssize(x));
  if (first_ > 0) right[0] = value - vector(row).dot(all);
  right.segment(first_, held()) = -directions_.transpose() * all;
  for (int j = 0; j < held(); ++j) right[first_ + held() + j] = -all[pinned_[j]];
  // Rows have units of their own.
  const Eigen::VectorXd unit = s.rowwise().lpNorm<Eigen::Infinity>();
  for (Eigen::Index i = 0; i < s.rows(); ++i)
    if (unit[i] > 0) s.row(i) /= unit[i], right[i] /= unit[i];
  const Eigen::VectorXd border = least_norm(s, right, dependent);
  all.noalias() -= solved_ * border;
  return first_ > 0 ? border[0] : 0;
}

/// By Haynsworth, of A and of its Schur complement, less 1/κ. A border of directions that are null adds as
/// many negative eigenvalues and positive ones to those across them.
Inertia SparseBorder::inertia(SparseSymmetric& a, std::span<const double> first, double corner) const {
  Inertia result = a.inertia();
  const int h = held(), with_first = first.empty() ? 0 : first_, size = with_first + 2 * h;
  if (size == 0) return result;
  const std::vector<double> none(with_first > 0 ? 0 : solved_.rows(), 0.0);
  const Eigen::MatrixXd s = schur(with_first > 0 ? first : none, corner).bottomRightCorner(size, size);
  // The last diagonal entries are zero where H is null along the directions held.
  const Eigen::VectorXd unit = s.rowwise().lpNorm<Eigen::Infinity>().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * (s + s.transpose()) * unit.asDiagonal();
  const Eigen::VectorXd values = symmetric_eigenvalues(scaled);
  for (const double value : values) ++(value < 0 ? result.negative : result.positive);
  result.negative -= h;
  result.positive -= 2 * h;
  result.zero += h;
  return result;
}

}  // namespace extremal
