#include "solve/node_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace extremal {

namespace {

/// Pivots of the border this much smaller than the largest are null directions: families of extremals, whose
/// eigenvalue is zero but for the error of the elements.
constexpr double singular_border = 1e-8;

/// Without the temporary of PartialPivLU::solve.
void solve_in_place(const Eigen::PartialPivLU<Eigen::MatrixXd>& lu, Eigen::VectorXd& x,
                    Eigen::VectorXd& permuted) {
  const auto& swaps = lu.permutationP().indices();
  const Eigen::Index size = x.size();
  permuted.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) permuted[swaps[i]] = x[i];
  const auto& factor = lu.matrixLU();
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < i; ++j) permuted[i] -= factor(i, j) * permuted[j];
  for (Eigen::Index i = size - 1; i >= 0; --i) {
    for (Eigen::Index j = i + 1; j < size; ++j) permuted[i] -= factor(i, j) * permuted[j];
    permuted[i] /= factor(i, i);
  }
  x.swap(permuted);
}

}  // namespace

void NodeSystem::reset(const EndMap& ends, int elements, int coordinates, bool free_duration) {
  ends_ = &ends;
  n_ = coordinates;
  elements_ = elements;
  free_ = ends.free;
  free_duration_ = free_duration;
  border_ = free_ + free_duration;
  const std::size_t inner = static_cast<std::size_t>(std::max(elements - 1, 0)) * n_;
  columns_.resize(inner * border_);
  solved_.resize(inner * border_);
  right_.resize(inner);
}

/// Adds factor × (column of end coordinate e) over the chain's nodes.
void NodeSystem::add_end(double* column, int stride, int e, double factor, const NodeEquations& nodes) const {
  if (elements_ < 2) return;
  if (e < n_) {
    for (int i = 0; i < n_; ++i) column[i * stride] += factor * nodes.first_lower[i * n_ + e];
  } else {
    double* last = column + static_cast<std::size_t>(elements_ - 2) * n_ * stride;
    for (int i = 0; i < n_; ++i) last[i * stride] += factor * nodes.last_lower[(e - n_) * n_ + i];
  }
}

void NodeSystem::assemble_border(const NodeEquations& nodes) {
  std::fill(columns_.begin(), columns_.end(), 0.0);
  schur_.setZero(border_, border_);
  for (const Triplet& z : ends_->z) add_end(columns_.data() + z.column, border_, z.row, z.value, nodes);
  for (const Triplet& z : ends_->z)
    for (const Triplet& w : ends_->z) {
      double value = 0;
      if (z.row < n_ && w.row < n_) value = nodes.first[z.row * n_ + w.row];
      if (z.row >= n_ && w.row >= n_) value = nodes.last[(z.row - n_) * n_ + w.row - n_];
      if (elements_ == 1 && z.row >= n_ && w.row < n_) value = nodes.first_lower[(z.row - n_) * n_ + w.row];
      if (elements_ == 1 && z.row < n_ && w.row >= n_) value = nodes.first_lower[(w.row - n_) * n_ + z.row];
      schur_(z.column, w.column) += z.value * w.value * value;
    }
  if (!free_duration_) return;
  const std::size_t inner = right_.size(), last = static_cast<std::size_t>(elements_) * n_;
  for (std::size_t k = 0; k < inner; ++k) columns_[k * border_ + free_] = nodes.border[n_ + k];
  for (const Triplet& z : ends_->z) {
    const double t = z.value * (z.row < n_ ? nodes.border[z.row] : nodes.border[last + z.row - n_]);
    schur_(z.column, free_) += t;
    schur_(free_, z.column) += t;
  }
  schur_(free_, free_) = nodes.corner;
}

bool NodeSystem::factor(NodeEquations& nodes, const ClosingEquation* closing) {
  chain_ = &nodes.chain;
  if (elements_ > 1 && !nodes.chain.factor()) return false;
  if (border_ == 0) return true;
  assemble_border(nodes);
  solved_ = columns_;
  if (elements_ > 1) nodes.chain.solve(solved_.data(), border_);
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMatrix> c(columns_.data(), right_.size(), border_),
      x(solved_.data(), right_.size(), border_);
  schur_.noalias() -= c.transpose().lazyProduct(x);
  symmetric_ = schur_.topLeftCorner(free_, free_);
  if (closing && !closing->row.empty()) {
    schur_.row(free_).setZero();
    for (const Triplet& z : ends_->z) schur_(free_, z.column) += closing->row[z.row] * z.value;
  }
  if (!schur_.allFinite()) return false;
  lu_.compute(schur_);
  const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
  if (pivots.minCoeff() > singular_border * pivots.maxCoeff()) {
    least_norm_.reset();
    return true;
  }
  // A family of extremals: of all steps the shortest.
  least_norm_.emplace(schur_.rows(), schur_.cols());
  least_norm_->setThreshold(singular_border).compute(schur_);
  return least_norm_->rank() > 0;
}

void NodeSystem::solve(const NodeEquations& nodes, const ClosingEquation* closing, std::vector<double>& step,
                       double& duration_step) {
  const std::size_t inner = right_.size(), last = static_cast<std::size_t>(elements_) * n_;
  for (std::size_t k = 0; k < inner; ++k) right_[k] = -nodes.gradient[n_ + k];
  if (elements_ > 1) chain_->solve(right_.data(), 1);
  step.assign(last + n_, 0);
  duration_step = 0;
  std::copy(right_.begin(), right_.end(), step.begin() + n_);
  if (border_ == 0) return;

  const bool own_row = closing && !closing->row.empty();
  Eigen::VectorXd& r = small_;
  r.setZero(border_);
  for (const Triplet& z : ends_->z)
    r[z.column] -= z.value * (z.row < n_ ? nodes.gradient[z.row] : nodes.gradient[last + z.row - n_]);
  if (free_duration_) r[free_] = own_row ? -closing->value : -(nodes.border_gradient + closing->value);
  for (std::size_t k = 0; k < inner; ++k)
    for (int c = 0; c < border_; ++c)
      if (!(own_row && c == free_)) r[c] -= columns_[k * border_ + c] * right_[k];
  if (least_norm_)
    r = least_norm_->solve(r).eval();
  else
    solve_in_place(lu_, r, permuted_);
  const Eigen::VectorXd& y = r;
  for (std::size_t k = 0; k < inner; ++k)
    for (int c = 0; c < border_; ++c) step[n_ + k] -= solved_[k * border_ + c] * y[c];
  for (const Triplet& z : ends_->z) step[z.row < n_ ? z.row : last + z.row - n_] += z.value * y[z.column];
  duration_step = free_duration_ ? y[free_] : 0;
}

Inertia NodeSystem::inertia(double threshold) const {
  Inertia result = elements_ > 1 ? chain_->inertia() : Inertia{};
  if (free_ == 0) return result;
  const Eigen::MatrixXd even = (symmetric_ + symmetric_.transpose()) / 2;
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(even, Eigen::EigenvaluesOnly).eigenvalues();
  const double scale = eigenvalues.cwiseAbs().maxCoeff();
  for (double value : eigenvalues)
    ++(std::abs(value) <= threshold * scale ? result.zero : value < 0 ? result.negative : result.positive);
  return result;
}

}  // namespace extremal
