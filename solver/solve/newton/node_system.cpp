#include "solve/newton/node_system.hpp"

#include <algorithm>
#include <cmath>

#include "solve/mesh/roundoff.hpp"
#include "solve/newton/limits.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

namespace extremal {

using namespace limits::node_system;

namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Whether the equation that closes the duration is not ∂S/∂T + energy = 0.
bool has_own_row(const ClosingEquation* closing) { return closing && !closing->row.empty(); }

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
  null_below_ = zero_eigenvalue;
  border_ = 0;  // no factors yet
  right_.resize(static_cast<std::size_t>(std::max(elements - 1, 0)) * n_);
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
  corner_.setZero(border_, border_);
  for (const Triplet& z : ends_->z) add_end(columns_.data() + z.column, border_, z.row, z.value, nodes);
  for (const Triplet& z : ends_->z)
    for (const Triplet& w : ends_->z) {
      double value = 0;
      if (z.row < n_ && w.row < n_) value = nodes.first[z.row * n_ + w.row];
      if (z.row >= n_ && w.row >= n_) value = nodes.last[(z.row - n_) * n_ + w.row - n_];
      if (elements_ == 1 && z.row >= n_ && w.row < n_) value = nodes.first_lower[(z.row - n_) * n_ + w.row];
      if (elements_ == 1 && z.row < n_ && w.row >= n_) value = nodes.first_lower[(w.row - n_) * n_ + z.row];
      corner_(z.column, w.column) += z.value * w.value * value;
    }
  if (!free_duration_) return;
  const std::size_t inner = right_.size(), last = static_cast<std::size_t>(elements_) * n_;
  for (std::size_t k = 0; k < inner; ++k) columns_[k * border_ + free_] = nodes.border[n_ + k];
  for (const Triplet& z : ends_->z) {
    const double t = z.value * (z.row < n_ ? nodes.border[z.row] : nodes.border[last + z.row - n_]);
    corner_(z.column, free_) += t;
    corner_(free_, z.column) += t;
  }
  corner_(free_, free_) = nodes.corner;
}

void NodeSystem::assemble_phases() {
  const std::size_t inner = right_.size();
  for (int j = 0, column = border_ - held_; j < held_; ++j, ++column) {
    const std::span<const double> direction = phases_->direction(j);
    for (std::size_t k = 0; k < inner; ++k) columns_[k * border_ + column] = direction[n_ + k];
    for (const Triplet& z : ends_->z) {
      const double along = z.value * direction[end_index(z.row)];
      corner_(z.column, column) += along;
      corner_(column, z.column) += along;
    }
  }
}

/// Where the mass vanishes at an end, as at a radius of zero, the second variation there is small in all its
/// parts: no direction is null for that. The ends get units in which the parts are of one size.
void NodeSystem::scale_ends() {
  const auto parts = corner_.diagonal().cwiseAbs();
  const double largest = parts.maxCoeff();
  for (int j = 0; j < free_; ++j)
    if (parts[j] > 0 && parts[j] < light_end * largest) column_units_[j] = std::sqrt(largest / parts[j]);
  row_units_ = column_units_;
  schur_.array().colwise() *= row_units_.array();
  schur_.array().rowwise() *= column_units_.transpose().array();
}

/// The duration and directions that are held have units of their own; pivots are compared. A row that is the
/// roundoff of its terms is null, and stays so.
void NodeSystem::scale_border(bool own_row) {
  column_units_.setOnes(border_);
  row_units_.setOnes(border_);
  if (border_ == free_) return scale_ends();
  const double curvature = free_ > 0 ? schur_.topLeftCorner(free_, free_).cwiseAbs().maxCoeff() : 0;
  for (int j = free_; j < border_ && curvature > 0; ++j) {
    const double along = schur_.col(j).head(free_).cwiseAbs().maxCoeff();
    const double size = std::max(along, std::sqrt(curvature * std::abs(schur_(j, j))));
    double terms = std::abs(corner_(j, j));
    for (std::size_t k = j; k < columns_.size(); k += border_) terms += std::abs(columns_[k] * solved_[k]);
    if (size > negligible * std::sqrt(curvature * terms)) column_units_[j] = curvature / size;
  }
  schur_.array().rowwise() *= column_units_.transpose().array();
  row_units_ = column_units_;
  if (own_row) {
    const double size = schur_.row(free_).cwiseAbs().maxCoeff();
    row_units_[free_] = size > 0 && curvature > 0 ? curvature / size : 1;
  }
  schur_.array().colwise() *= row_units_.array();
}

bool NodeSystem::factor(NodeEquations& nodes, const ClosingEquation* closing, const PhaseConditions* phases) {
  chain_ = &nodes.chain;
  phases_ = phases;
  held_ = phases ? phases->count : 0;
  border_ = free_ + free_duration_ + held_;
  columns_.resize(right_.size() * border_);
  solved_.resize(columns_.size());
  // Alone, an almost singular chain is the whole system; with a border it is better left to that.
  const bool regular = elements_ < 2 || chain_->factor(border_ > 0 ? zero_eigenvalue : 0);
  exact_ = !regular && border_ > 0 && !chain_->deflated().empty();
  if (!regular && !exact_) return false;
  // Between fixed ends there are as many null directions as coordinates, at most; many more are noise.
  if (chain_->deflated().size() > most_deflated * static_cast<std::size_t>(n_)) return false;
  if (border_ == 0) return true;
  assemble_border(nodes);
  if (held_ > 0) assemble_phases();
  return exact_ ? factor_exactly(closing) : factor_schur(closing);
}

/// The Schur complement of a regular chain.
bool NodeSystem::factor_schur(const ClosingEquation* closing) {
  solved_ = columns_;
  if (elements_ > 1) chain_->solve(solved_.data(), border_);
  const Eigen::Map<const RowMatrix> c(columns_.data(), right_.size(), border_),
      x(solved_.data(), right_.size(), border_);
  schur_ = corner_;
  schur_.noalias() -= c.transpose().lazyProduct(x);
  if (has_own_row(closing)) {
    schur_.row(free_).setZero();
    for (const Triplet& z : ends_->z) schur_(free_, z.column) += closing->row[z.row] * z.value;
    schur_(free_, free_) = closing->by_duration;
  }
  scale_border(has_own_row(closing));
  if (!schur_.allFinite()) return false;
  factor_border();
  return true;
}

void NodeSystem::set_null_below(double threshold) {
  null_below_ = threshold;
  if (border_ > 0 && !exact_) factor_border();
}

void NodeSystem::factor_border() {
  lu_.compute(schur_);
  const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
  // A pivot of zero becomes roundoff, which makes the null direction the largest part of a step.
  if (null_below_ == 0 && pivots.minCoeff() == 0) {
    const double size = free_ > 0 ? corner_.topLeftCorner(free_, free_).cwiseAbs().maxCoeff() : 1;
    schur_.diagonal().array() += 2 * unit_roundoff * std::max(size, schur_.cwiseAbs().maxCoeff());
    lu_.compute(schur_);
  }
  // All pivots are roundoff where large entries stand beside a null row and column alone.
  const double largest = schur_.cwiseAbs().maxCoeff();
  if (pivots.minCoeff() > null_below_ * pivots.maxCoeff() && pivots.maxCoeff() > null_below_ * largest) {
    least_norm_.reset();
    return;
  }
  // A family of extremals: of all steps the shortest.
  least_norm_.emplace(schur_.rows(), schur_.cols());
  least_norm_->setThreshold(null_below_).compute(schur_);
}

/// The ends are conjugate as if both were fixed, but are not both fixed: the system may be regular all the
/// same.
bool NodeSystem::factor_exactly(const ClosingEquation* closing) {
  const bool own_row = has_own_row(closing);
  const int inner = static_cast<int>(right_.size());
  system_.resize(inner, border_, !own_row);
  std::copy(columns_.begin(), columns_.end(), system_.column_block());
  Eigen::Map<RowMatrix> corner(system_.corner(), border_, border_);
  corner = corner_;
  if (own_row) {
    corner.row(free_).setZero();
    for (const Triplet& z : ends_->z) corner(free_, z.column) += closing->row[z.row] * z.value;
    corner(free_, free_) = closing->by_duration;
    Eigen::Map<RowMatrix> rows(system_.row_block(), inner, border_);
    rows = Eigen::Map<const RowMatrix>(columns_.data(), inner, border_);
    rows.col(free_).setZero();
  }
  regular_ = system_.factor(*chain_);
  const Eigen::VectorXd sizes = system_.singular_values();
  if (sizes.size() == 0) return false;
  smallest_ = sizes.minCoeff();
  return true;
}

/// Minus the derivatives by the free unknowns of the ends, and minus the residual of the closing equation.
void NodeSystem::border_right(const NodeEquations& nodes, const ClosingEquation* closing) {
  const std::size_t last = static_cast<std::size_t>(elements_) * n_;
  small_.setZero(border_);
  if (!nodes.end_parts.empty())
    for (const Triplet& z : ends_->z) small_[z.column] -= z.value * nodes.end_parts[z.row];
  for (const Triplet& z : ends_->z)
    small_[z.column] -= z.value * (z.row < n_ ? nodes.gradient[z.row] : nodes.gradient[last + z.row - n_]);
  if (!free_duration_) return;
  small_[free_] = -closing->value;
  if (!has_own_row(closing)) small_[free_] -= nodes.border_part;
  if (!has_own_row(closing)) small_[free_] -= nodes.border_gradient;
}

void NodeSystem::solve(const NodeEquations& nodes, const ClosingEquation* closing, std::vector<double>& step,
                       double& duration_step, bool refine) {
  const std::size_t inner = right_.size(), last = static_cast<std::size_t>(elements_) * n_;
  for (std::size_t k = 0; k < inner; ++k) right_[k] = -nodes.gradient[n_ + k];
  border_right(nodes, closing);
  if (exact_)
    solve_exactly();
  else
    solve_schur(has_own_row(closing), refine);
  step.assign(last + n_, 0);
  std::copy(right_.begin(), right_.end(), step.begin() + n_);
  for (const Triplet& z : ends_->z)
    step[z.row < n_ ? z.row : last + z.row - n_] += z.value * small_[z.column];
  duration_step = free_duration_ ? small_[free_] : 0;
}

/// right_ and small_ become the solution.
void NodeSystem::solve_schur(bool own_row, bool refine) {
  const std::size_t inner = right_.size();
  if (elements_ > 1) refine ? chain_->solve(right_.data(), 1) : chain_->solve_step(right_.data());
  left_out_ = 0;
  if (border_ == 0) return;
  for (std::size_t k = 0; k < inner; ++k)
    for (int c = 0; c < border_; ++c)
      if (!(own_row && c == free_)) small_[c] -= columns_[k * border_ + c] * right_[k];
  small_.array() *= row_units_.array();
  if (least_norm_) {
    left_out_ = static_cast<int>(least_norm_->cols() - least_norm_->rank());
    small_ = least_norm_->solve(small_).eval();
  } else
    solve_in_place(lu_, small_, permuted_);
  small_.array() *= column_units_.array();
  for (std::size_t k = 0; k < inner; ++k)
    for (int c = 0; c < border_; ++c) right_[k] -= solved_[k * border_ + c] * small_[c];
}

void NodeSystem::solve_exactly() {
  Eigen::VectorXd all(right_.size() + border_);
  all << Eigen::Map<const Eigen::VectorXd>(right_.data(), right_.size()), small_;
  left_out_ = 0;
  if (regular_ && smallest_ > null_below_)
    system_.solve(*chain_, all.data(), 1);
  else
    left_out_ = system_.solve_least_norm(*chain_, all.data(), 1, null_below_);
  std::copy_n(all.begin(), right_.size(), right_.begin());
  small_ = all.tail(border_);
}

Inertia NodeSystem::inertia(double threshold, VariedBy by) const {
  // The column of the duration follows those of the ends.
  const int varied = free_ + (by == VariedBy::path_and_duration && free_duration_);
  if (elements_ < 2 && varied == 0) return {};
  if (varied == 0 && held_ == 0 && chain_->deflated().empty()) return chain_->inertia();
  // A border of r directions that are null but for the error of the elements adds r negative eigenvalues to
  // those of the directions across, and as many positive ones.
  const PhaseConditions held = phases_ ? independent(*phases_) : PhaseConditions{};
  // Roundoff may give the chain, whose ends are held, an eigenvalue of either sign along a direction that is
  // held. A spring σ at the node that it moves most, and a column e with the corner 1/σ, which takes the
  // spring back, leave the inertia but for one positive eigenvalue.
  const int springs = right_.empty() ? 0 : held.count, columns = varied + held.count + springs;
  Chain chain = *chain_;
  Border ends;
  ends.resize(static_cast<int>(right_.size()), columns);
  Eigen::Map<RowMatrix> block(ends.column_block(), std::ssize(right_), columns),
      corner(ends.corner(), columns, columns);
  block.setZero();
  block.leftCols(varied) =
      Eigen::Map<const RowMatrix>(columns_.data(), std::ssize(right_), border_).leftCols(varied);
  corner.setZero();
  corner.topLeftCorner(varied, varied) = corner_.topLeftCorner(varied, varied);
  for (int j = 0; j < held.count; ++j) {
    const double* direction = held.direction(j).data();
    for (Eigen::Index k = 0; k < block.rows(); ++k) block(k, varied + j) = direction[n_ + k];
    for (const Triplet& z : ends_->z) {
      corner(z.column, varied + j) += z.value * direction[end_index(z.row)];
      corner(varied + j, z.column) = corner(z.column, varied + j);
    }
  }
  for (int j = 0; j < springs; ++j) {
    Eigen::Index row = 0;
    block.col(varied + j).cwiseAbs().maxCoeff(&row);
    double& entry = chain.diagonal(static_cast<int>(row / n_))[row % n_ * (n_ + 1)];
    const double spring = entry != 0 ? std::abs(entry) : 1;
    entry += spring;
    block(row, varied + held.count + j) = 1;
    corner(varied + held.count + j, varied + held.count + j) = 1 / spring;
  }
  ends.factor(chain, std::max(threshold, zero_eigenvalue));
  // With more null directions than can be afforded: as for steps.
  if (!ends.finite()) ends.factor(chain);
  // A pivot may vanish altogether: roundoff of the largest entry, added to all, leaves the other signs.
  if (!ends.finite()) {
    double largest = 0;
    for (int k = 0; k < chain.blocks(); ++k)
      for (int a = 0; a < n_; ++a) largest = std::max(largest, std::abs(chain.diagonal(k)[a * (n_ + 1)]));
    for (int k = 0; k < chain.blocks(); ++k)
      for (int a = 0; a < n_; ++a) chain.diagonal(k)[a * (n_ + 1)] += zero_eigenvalue * largest;
    ends.factor(chain);
  }
  Inertia result = ends.inertia(threshold);
  result.positive -= springs;
  // Fewer than r of either sign: some of them are among those that were too small to tell.
  const int negative = std::max(result.negative, held.count),
            positive = std::max(result.positive, held.count);
  result.zero -= negative - result.negative + positive - result.positive;
  result.negative = negative - held.count;
  result.positive = positive - held.count;
  result.zero += held.count;
  return result;
}

}  // namespace extremal
