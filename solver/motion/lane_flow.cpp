#include "motion/lane_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "linear/dense.hpp"
#include "motion/flow.hpp"
#include "system/hamiltonian.hpp"

namespace extremal {

namespace {

constexpr int most_corrections = 20;
/// ∂L/∂q' agrees with p to roundoff; from below `nearly` the next step of Newton ends in it, or in what is
/// taken.
constexpr double agrees = 2e-15, nearly = 1e-8, taken = 1e-12;

}  // namespace

LaneFlow::LaneFlow(const Lagrangian& lagrangian, int copies)
    : lagrangian_(lagrangian),
      hamiltonian_(hamiltonian_of(lagrangian)),
      structure_(lagrangian.structure()),
      all_(structure_.coordinates),
      n_(all_ / copies),
      kernels_(at_simd_level(EXTREMAL_AT_EACH_LEVEL(lane_kernels))()),
      gradient_q_(n_, -1),
      gradient_v_(n_, -1),
      v_(static_cast<std::size_t>(n_) * lanes_),
      out_(static_cast<std::size_t>(lagrangian.rows(Order::hessian)) * lanes_),
      work_(static_cast<std::size_t>(n_) * lanes_),
      copies_(copies == 1 ? 0 : static_cast<std::size_t>(2 * all_) * lanes_) {
  std::fill(v_.begin(), v_.end(), nearly_at_rest);
  for (std::size_t k = 0; k < structure_.gradient.size(); ++k) {
    const int z = structure_.gradient[k];
    if (z % all_ < n_) (z < all_ ? gradient_q_[z] : gradient_v_[z - all_]) = static_cast<int>(1 + k);
  }
  if (!structure_.linear.empty()) linear_.assign(structure_.linear.begin(), structure_.linear.begin() + n_);
  if (structure_.quadratic)
    invert_mass();
  else
    factors_.resize(static_cast<std::size_t>(n_) * n_ * lanes_);
  list_entries();
}

void LaneFlow::invert_mass() {
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n_, n_);
  for (const Triplet& m : structure_.mass)
    if (m.row < n_ && m.column < n_) mass(m.row, m.column) += m.value;
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(mass);
  if (!(factors.matrixLU().diagonal().cwiseAbs().minCoeff() > 0))
    throw std::invalid_argument("the mass matrix of the Lagrangian is singular");
  const Eigen::MatrixXd inverse = factors.inverse();
  std::vector<double> values;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j)
      if (inverse(i, j) != 0) {
        mass_inverse_.push_back({i, j, nullptr});
        values.push_back(inverse(i, j));
      }
  for (const Triplet& c : structure_.gyroscopic)
    if (c.row < n_) {
      vq_.push_back({c.row, c.column % n_, nullptr});
      values.push_back(c.value);
    }
  for (const Triplet& c : structure_.gyroscopic)
    if (c.column < n_) {
      qv_.push_back({c.column, c.row % n_, nullptr});
      values.push_back(c.value);
    }
  constant_vq_ = static_cast<int>(vq_.size());
  constant_qv_ = static_cast<int>(qv_.size());
  constants_.resize(values.size() * lanes_);
  for (std::size_t k = 0; k < values.size(); ++k)
    std::fill_n(constants_.data() + k * lanes_, lanes_, values[k]);
  const double* next = constants_.data();
  for (std::vector<LaneEntry>* list : {&mass_inverse_, &vq_, &qv_})
    for (LaneEntry& entry : *list) {
      entry.value = next;
      next += lanes_;
    }
}

/// Of the first copy in all of them: see PointEvaluator. The Hessian by velocities is that of the first
/// alone, as the forces do not change it where copies agree; its lower triangle is listed.
void LaneFlow::list_entry(int row, int column, const double* value) {
  if (row % all_ >= n_) return;
  const LaneEntry entry{row % all_, (column % all_) % n_, value};
  if (row < all_) {
    (column < all_ ? qq_ : qv_).push_back(entry);
  } else if (column < all_) {
    vq_.push_back(entry);
  } else if (column - all_ < n_ && column <= row) {
    vv_.push_back(entry);
  }
}

/// Second derivatives where the tape writes them.
void LaneFlow::list_entries() {
  const double* value = out_.data() + (1 + structure_.gradient.size()) * lanes_;
  for (const auto& [row, column] : structure_.hessian) {
    list_entry(row, column, value);
    if (row != column) list_entry(column, row, value);
    value += lanes_;
  }
}

void LaneFlow::evaluate(const double* t, const double* y, Order order) {
  const std::size_t half = static_cast<std::size_t>(n_) * lanes_;
  const double *q = y, *v = v_.data();
  if (n_ < all_) {
    for (int copy = 0; copy < 2; ++copy) {
      std::copy_n(y, half, copies_.data() + copy * half);
      std::copy_n(v_.data(), half, copies_.data() + (2 + copy) * half);
    }
    q = copies_.data();
    v = q + 2 * half;
  }
  lagrangian_.evaluate({lanes_, lanes_, q, v, t}, order, out_.data(), scratch_);
}

/// q' from p, left in v_; and in out_ the derivatives up to `order` there.
void LaneFlow::solve_velocity(const double* t, const double* y, Order order) {
  const double* const p = y + static_cast<std::size_t>(n_) * lanes_;
  if (structure_.quadratic) {
    std::copy_n(p, n_ * lanes_, work_.data());
    kernels_.add_products(vq_.data(), constant_vq_, -1, y, work_.data(), 1, 0, 0);
    for (std::size_t a = 0; a < linear_.size(); ++a)
      for (int lane = 0; lane < lanes_; ++lane) work_[a * lanes_ + lane] -= linear_[a];
    std::fill(v_.begin(), v_.end(), 0.0);
    kernels_.add_products(mass_inverse_.data(), static_cast<int>(mass_inverse_.size()), 1, work_.data(),
                          v_.data(), 1, 0, 0);
    evaluate(t, y, order);
    return;
  }
  if (hamiltonian_) {
    hamiltonian_->evaluate({lanes_, lanes_, y, p, t}, Order::gradient, out_.data(), scratch_);
    for (int a = 0; a < n_; ++a)
      std::copy_n(out_.data() + gradient_v_[a] * lanes_, lanes_, v_.data() + a * lanes_);
    std::replace_if(
        v_.begin(), v_.end(), [](double v) { return !std::isfinite(v); }, 0.0);
  }
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_corrections; ++i) {
    evaluate(t, y, Order::hessian);
    if (!correct_velocity(p, before)) break;
  }
}

/// Factors ∂²L/∂q'∂q' and takes a step of Newton, unless v_ belongs to p already: then false. The worst lane
/// counts; lanes that are not finite do not.
bool LaneFlow::correct_velocity(const double* p, double& before) {
  double size[most_lanes] = {}, worst = 0;
  residual_.fill(0);
  for (int a = 0; a < n_; ++a)
    for (int lane = 0; lane < lanes_; ++lane) {
      const double momentum = gradient_v_[a] < 0 ? 0 : out_[gradient_v_[a] * lanes_ + lane];
      const double r = p[a * lanes_ + lane] - momentum;
      work_[a * lanes_ + lane] = r;
      residual_[lane] = std::abs(r) <= residual_[lane] ? residual_[lane] : std::abs(r);
      size[lane] = std::max({size[lane], std::abs(p[a * lanes_ + lane]), std::abs(momentum)});
    }
  for (int lane = 0; lane < lanes_; ++lane) {
    if (size[lane] > 0) residual_[lane] /= size[lane];
    if (std::isfinite(residual_[lane])) worst = std::max(worst, residual_[lane]);
  }
  std::fill(factors_.begin(), factors_.end(), 0.0);
  for (const LaneEntry& e : vv_)
    std::copy_n(e.value, lanes_, factors_.data() + static_cast<std::size_t>(e.row * n_ + e.column) * lanes_);
  kernels_.factor(factors_.data(), n_);
  if (worst <= agrees || (before <= nearly && worst <= taken)) return false;
  before = worst;
  kernels_.solve(factors_.data(), n_, work_.data(), 1, 0);
  for (int i = 0; i < n_ * lanes_; ++i) {
    v_[i] += work_[i];
    // A lane that has been lost starts anew.
    if (!std::isfinite(v_[i])) v_[i] = nearly_at_rest;
  }
  return true;
}

/// ∂L/∂q.
void LaneFlow::write_force(double* force) {
  for (int a = 0; a < n_; ++a) {
    double* const to = force + a * lanes_;
    if (gradient_q_[a] < 0)
      std::fill_n(to, lanes_, 0.0);
    else
      std::copy_n(out_.data() + gradient_q_[a] * lanes_, lanes_, to);
  }
  kernels_.add_products(qv_.data(), constant_qv_, 1, v_.data(), force, 1, 0, 0);
}

/// L_vv δq' = δp − L_vq δq,  δp' = L_qq δq + L_vqᵀ δq'.
void LaneFlow::vary(const double* y, int columns, double* slope) {
  const std::size_t half = static_cast<std::size_t>(n_) * lanes_;
  const long stride = 2L * n_;
  const auto count = [](const std::vector<LaneEntry>& entries) { return static_cast<int>(entries.size()); };
  double* const right = structure_.quadratic ? work_.data() : slope;
  const long right_stride = structure_.quadratic ? n_ : stride;
  for (int c = 0; c < columns; ++c) {
    std::copy_n(y + c * 2 * half + half, half, right + c * right_stride * lanes_);
    std::fill_n(slope + c * 2 * half + half, half, 0.0);
    if (structure_.quadratic) std::fill_n(slope + c * 2 * half, half, 0.0);
  }
  kernels_.add_products(vq_.data(), count(vq_), -1, y, right, columns, stride, right_stride);
  if (structure_.quadratic)
    kernels_.add_products(mass_inverse_.data(), count(mass_inverse_), 1, right, slope, columns, right_stride,
                          stride);
  else
    kernels_.solve(factors_.data(), n_, slope, columns, stride);
  kernels_.add_products(qq_.data(), count(qq_), 1, y, slope + half, columns, stride, stride);
  kernels_.add_products(qv_.data(), count(qv_), 1, slope, slope + half, columns, stride, stride);
}

void LaneFlow::slope(const double* t, const double* y, int columns, double* slope) {
  const std::size_t half = static_cast<std::size_t>(n_) * lanes_;
  work_.resize(std::max(work_.size(), half * columns));
  solve_velocity(t, y, columns > 0 ? Order::hessian : Order::gradient);
  std::copy_n(v_.data(), half, slope);
  for (int lane = 0; lane < lanes_ && !structure_.quadratic; ++lane)
    if (!(residual_[lane] <= taken)) slope[lane] = std::numeric_limits<double>::quiet_NaN();
  write_force(slope + half);
  if (columns > 0) vary(y + 2 * half, columns, slope + 2 * half);
}

}  // namespace extremal
