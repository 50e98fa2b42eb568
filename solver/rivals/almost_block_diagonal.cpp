#include "rivals/almost_block_diagonal.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

/// Singular values below this part of the largest count as zero.
constexpr double dependent = 1e-8;

}  // namespace

bool AlmostBlockDiagonal::Solution::finite() const {
  return first.allFinite() && std::isfinite(extra) &&
         std::all_of(rest.begin(), rest.end(), [](const Eigen::VectorXd& x) { return x.allFinite(); });
}

/// LU of the first b columns, with the largest pivot of each.
void AlmostBlockDiagonal::eliminate(Elimination& stage) const {
  Matrix& a = stage.rows;
  stage.exchange.resize(size_);
  const Eigen::Index width = a.cols();
  for (int j = 0; j < size_; ++j) {
    Eigen::Index pivot = 0;
    a.col(j).tail(2 * size_ - j).cwiseAbs().maxCoeff(&pivot);
    stage.exchange[j] = j + static_cast<int>(pivot);
    a.row(j).swap(a.row(stage.exchange[j]));
    for (int i = j + 1; i < 2 * size_; ++i) {
      if (a(i, j) == 0) continue;
      const double factor = a(i, j) /= a(j, j);
      const double* const from = a.data() + j * width;
      double* const to = a.data() + i * width;
      for (Eigen::Index c = j + 1; c < width; ++c) to[c] -= factor * from[c];
    }
  }
}

void AlmostBlockDiagonal::factor(const Blocks& blocks) {
  const auto count = static_cast<int>(blocks.transition.size());
  size_ = static_cast<int>(blocks.transition.front().rows());
  first_ = static_cast<int>(blocks.transition.front().cols());
  extra_ = blocks.extra.empty() ? 0 : 1;
  stages_.resize(count - 1);
  Eigen::MatrixXd last;
  if (count == 1)
    last = substituted(blocks);
  else
    last = chained(blocks);
  least_norm_ = blocks.may_be_singular;
  if (least_norm_) {
    shortest_.setThreshold(dependent);
    shortest_.compute(last);
  } else {
    last_.compute(last);
  }
}

/// The last rows over y and τ alone, with x_1 = Φ_0 y + f_0 τ − c_0.
Eigen::MatrixXd AlmostBlockDiagonal::substituted(const Blocks& blocks) {
  through_.resize(size_, first_ + extra_);
  through_.leftCols(first_) = blocks.transition.front();
  if (extra_) through_.col(first_) = blocks.extra.front();
  by_last_ = blocks.by_last;
  Eigen::MatrixXd last = by_last_ * through_;
  last.leftCols(first_) += blocks.by_first;
  if (extra_) last.col(first_) += blocks.by_extra;
  return last;
}

/// The last rows over x_m, y and τ, below what elimination has left of the others.
Eigen::MatrixXd AlmostBlockDiagonal::chained(const Blocks& blocks) {
  const auto count = static_cast<int>(blocks.transition.size());
  const int others = first_ + extra_;
  // What is known between x_{k+1}, y and τ.
  Matrix known(size_, size_ + others);
  known.leftCols(size_).setIdentity() *= -1;
  known.middleCols(size_, first_) = blocks.transition.front();
  if (extra_) known.col(size_ + first_) = blocks.extra.front();
  for (int k = 1; k < count; ++k) {
    Elimination& stage = stages_[k - 1];
    stage.rows.setZero(2 * size_, 2 * size_ + others);
    stage.rows.topLeftCorner(size_, size_) = known.leftCols(size_);
    stage.rows.topRightCorner(size_, others) = known.rightCols(others);
    stage.rows.bottomLeftCorner(size_, size_) = blocks.transition[k];
    stage.rows.block(size_, size_, size_, size_).diagonal().setConstant(-1);
    if (extra_) stage.rows.bottomRightCorner(size_, 1) = blocks.extra[k];
    eliminate(stage);
    known = stage.rows.bottomRightCorner(size_, size_ + others);
  }
  const Eigen::Index rows = blocks.by_first.rows();
  Eigen::MatrixXd last(size_ + rows, size_ + others);
  last.topRows(size_) = known;
  last.bottomLeftCorner(rows, size_) = blocks.by_last;
  last.block(size_, size_, rows, first_) = blocks.by_first;
  if (extra_) last.bottomRightCorner(rows, 1) = blocks.by_extra;
  return last;
}

Eigen::VectorXd AlmostBlockDiagonal::solve_last(const Eigen::VectorXd& right) const {
  if (least_norm_) return shortest_.solve(right);
  return last_.solve(right);
}

AlmostBlockDiagonal::Solution AlmostBlockDiagonal::solve(const std::vector<Eigen::VectorXd>& right) const {
  const int count = static_cast<int>(right.size()) - 1;
  if (count == 1) {
    const Eigen::VectorXd found = solve_last(right.back() + by_last_ * right.front());
    return {found.head(first_), {through_ * found - right.front()}, extra_ ? found[first_] : 0.0};
  }
  // Row k: what is known of x_k; below the last one, what goes on.
  Matrix carried(count + 1, size_);
  carried.row(1) = right.front();
  std::vector<double> x(2 * size_);
  for (int k = 1; k < count; ++k) {
    const Elimination& stage = stages_[k - 1];
    std::copy_n(carried.data() + std::ptrdiff_t(k) * size_, size_, x.data());
    std::copy_n(right[k].data(), size_, x.data() + size_);
    for (int j = 0; j < size_; ++j) std::swap(x[j], x[stage.exchange[j]]);
    for (int i = 1; i < 2 * size_; ++i) {
      const double* const factors = stage.rows.data() + i * stage.rows.cols();
      for (int j = 0; j < std::min(i, size_); ++j) x[i] -= factors[j] * x[j];
    }
    std::copy_n(x.data(), 2 * size_, carried.data() + std::ptrdiff_t(k) * size_);
  }
  Eigen::VectorXd ends(size_ + right.back().size());
  ends << carried.row(count).transpose(), right.back();
  const Eigen::VectorXd found = solve_last(ends);
  Solution solution{found.segment(size_, first_), std::vector<Eigen::VectorXd>(count, found.head(size_)),
                    extra_ ? found[size_ + first_] : 0.0};
  for (int k = count - 1; k >= 1; --k)
    substitute_back(stages_[k - 1], carried.data() + std::ptrdiff_t(k) * size_, solution, k);
  return solution;
}

/// x_k from x_{k+1}, y and τ.
void AlmostBlockDiagonal::substitute_back(const Elimination& stage, const double* right, Solution& solution,
                                          int k) const {
  Eigen::VectorXd& x = solution.rest[k - 1];
  const Eigen::VectorXd& next = solution.rest[k];
  for (int i = size_ - 1; i >= 0; --i) {
    const double* const row = stage.rows.data() + i * stage.rows.cols();
    double value = right[i];
    for (int j = i + 1; j < size_; ++j) value -= row[j] * x[j];
    for (int j = 0; j < size_; ++j) value -= row[size_ + j] * next[j];
    for (int j = 0; j < first_; ++j) value -= row[2 * size_ + j] * solution.first[j];
    if (extra_) value -= row[2 * size_ + first_] * solution.extra;
    x[i] = value / row[i];
  }
}

}  // namespace extremal
