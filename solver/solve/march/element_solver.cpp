#include "solve/march/element_solver.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "linear/sparse_lu.hpp"
#include "solve/march/limits.hpp"

namespace extremal {

using namespace limits::march;

/// Where the unknowns are many; the equations of a lattice couple few of them.
struct ElementSolver::Sparse {
  Eigen::SparseMatrix<double> matrix;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factors;
  std::vector<Eigen::Triplet<double>> entries;
  bool analysed = false;
  /// Of a constant M; and the inverse of Σ b_i φ_I' φ_K', h/M times which nearly is that of the equations
  /// where h ω is small for every frequency ω.
  Eigen::SparseLU<Eigen::SparseMatrix<double>> mass;
  Eigen::MatrixXd stiffness, right;

  /// False where M is not constant or is singular.
  bool use_kinetic_energy(const StepTables& tables) {
    const Structure& structure = tables.lagrangian().structure();
    const StepShape& shape = tables.shape();
    if (!structure.quadratic) return false;
    std::vector<Eigen::Triplet<double>> of_mass;
    for (const Triplet& m : structure.mass) of_mass.emplace_back(m.row, m.column, m.value);
    Eigen::SparseMatrix<double> matrix(shape.n, shape.n);
    matrix.setFromTriplets(of_mass.begin(), of_mass.end());
    mass.compute(matrix);
    if (mass.info() != Eigen::Success) return false;
    Eigen::MatrixXd whole(shape.s, shape.s);
    for (int f = 0; f < shape.s; ++f)
      for (int k = 0; k < shape.s; ++k) whole(f, k) = shape.stiffness[k * shape.functions + f];
    stiffness = inverse(whole);
    return true;
  }
};

ElementSolver::ElementSolver(const StepTables& tables)
    : tables_(tables),
      shape_(tables.shape()),
      kernels_(step_kernels()),
      size_(tables.unknowns()),
      stride_((size_ + simd_lanes() - 1) / simd_lanes() * simd_lanes()),
      dense_(size_ <= most_dense),
      velocities_(!tables.lagrangian().structure().velocity_free),
      times_(!tables.lagrangian().structure().autonomous) {
  const std::size_t n = shape_.n, width = shape_.width;
  points_.assign((4 * n + 1) * width, 0.0);
  at_.q = points_.data();
  at_.v = at_.q + n * width;
  at_.dq = at_.v + n * width;
  at_.dv = at_.dq + n * width;
  at_.t = times_ ? at_.dv + n * width : nullptr;
  rows_.assign(static_cast<std::size_t>(tables.lagrangian().rows(Order::hessian)) * width, 0.0);
  at_.remainder = rows_.data();
  sums_.assign(n * shape_.functions, 0.0);
  if (dense_)
    matrix_.assign(static_cast<std::size_t>(size_) * stride_, 0.0);
  else
    sparse_ = std::make_unique<Sparse>();
  kinetic_ = sparse_ && sparse_->use_kinetic_energy(tables);
  residuals_.assign(stride_, 0.0);
  correction_.assign(stride_, 0.0);
  work_.assign(2 * static_cast<std::size_t>(size_), 0.0);
  x_.assign(stride_, 0.0);
  q_.assign(n, 0.0);
  force_.assign(n, 0.0);
  extent_.assign(n, 0.0);
  largest_.assign(n, 0.0);
}

ElementSolver::~ElementSolver() = default;

/// The equations at x, into residuals_.
bool ElementSolver::evaluate(const MotionState& state, double h, Order order) {
  const int n = shape_.n, s = shape_.s;
  kernels_.expand(shape_, at_, q_.data(), state.time, h, x_.data());
  const Points points{shape_.width, shape_.width, at_.q, velocities_ ? at_.v : nullptr, at_.t};
  tables_.lagrangian().evaluate(points, order, rows_.data(), scratch_);
  action_ = kernels_.gather(shape_, at_, h, sums_.data(), force_.data());
  double sum = action_;
  for (int a = 0; a < n; ++a) {
    double* const own = &residuals_[a * s];
    const double* const found = &sums_[a * shape_.functions];
    for (int k = 0; k < s; ++k) own[k] = found[k];
    // −∂L_d/∂q_k = p_k, where the derivatives by both ends sum up to `force`.
    own[s - 1] = ((state.p[a].high - own[s - 1]) + state.p[a].low) + force_[a];
    for (int k = 0; k < s; ++k) sum += own[k];
  }
  return std::isfinite(sum);
}

bool ElementSolver::factor(double h) {
  factored_ = false;
  factored_h_ = h;
  if (dense_) {
    kernels_.matrix(shape_, at_, h, matrix_.data(), stride_);
    return factored_ = kernels_.invert(size_, stride_, matrix_.data(), work_.data());
  }
  const double rate = 1 / h;
  const double* const hessian =
      rows_.data() + static_cast<std::size_t>(1 + shape_.gradient_count) * shape_.width;
  const auto row = [&](int k) {
    return k < 0 ? nullptr : hessian + static_cast<std::size_t>(k) * shape_.width;
  };
  const int s = shape_.s;
  sparse_->entries.clear();
  for (int e = 0; e < shape_.pair_count; ++e) {
    const CoupledPair& c = shape_.pairs[e];
    const double *qq = row(c.qq), *qv = row(c.qv), *vq = row(c.vq), *vv = row(c.vv);
    for (int f = 0; f < s; ++f)
      for (int k = 0; k < s; ++k) {
        double sum = c.velocities ? 0 : c.mass * rate * shape_.stiffness[k * shape_.functions + f];
        for (int i = 0; i < shape_.points; ++i) {
          const double value = shape_.trial_value[i * s + k], slope = shape_.trial_slope[i * s + k],
                       test = shape_.test_value[i * shape_.functions + f],
                       test_slope = shape_.test_slope[i * shape_.functions + f];
          if (qq) sum += h * qq[i] * value * test;
          if (c.velocities)
            sum += (c.qv0 + (qv ? qv[i] : 0)) * slope * test +
                   (c.vq0 + (vq ? vq[i] : 0)) * value * test_slope +
                   (c.mass + (vv ? vv[i] : 0)) * slope * rate * test_slope;
        }
        sparse_->entries.emplace_back(c.a * s + f, c.b * s + k, sum);
      }
  }
  sparse_->matrix.resize(size_, size_);
  sparse_->matrix.setFromTriplets(sparse_->entries.begin(), sparse_->entries.end());
  if (!sparse_->analysed) sparse_->factors.analyzePattern(sparse_->matrix);
  sparse_->analysed = true;
  sparse_->factors.factorize(sparse_->matrix);
  return factored_ = sparse_->factors.info() == Eigen::Success;
}

/// −h (Σ b φ'φ')⁻¹ M⁻¹ residuals_: cheap steps that converge where forces change the motion little over h.
void ElementSolver::correct_by_kinetic_energy() {
  const Eigen::Map<const Eigen::MatrixXd> residuals(residuals_.data(), shape_.s, shape_.n);
  Eigen::Map<Eigen::MatrixXd> correction(correction_.data(), shape_.s, shape_.n);
  sparse_->right = (sparse_->stiffness * residuals).transpose();
  correction = -factored_h_ * sparse_->mass.solve(sparse_->right).transpose();
}

/// correction_ = −(matrix)⁻¹ residuals_.
void ElementSolver::correct() {
  if (kinetic_) return correct_by_kinetic_energy();
  if (dense_) {
    kernels_.multiply(size_, stride_, matrix_.data(), residuals_.data(), correction_.data());
    return;
  }
  const Eigen::VectorXd step =
      sparse_->factors.solve(Eigen::Map<const Eigen::VectorXd>(residuals_.data(), size_));
  for (int k = 0; k < size_; ++k) correction_[k] = -step[k];
}

/// Adds the correction; its size, each coordinate measured by its own extent.
ElementSolver::Step ElementSolver::measure() {
  const int s = shape_.s;
  Step step;
  for (int a = 0; a < shape_.n; ++a) {
    extent_[a] = 0;
    for (int k = a * s; k < (a + 1) * s; ++k) {
      x_[k] += correction_[k];
      extent_[a] = std::max(extent_[a], std::abs(x_[k]));
    }
  }
  const double widest = *std::ranges::max_element(extent_),
               negligible = negligible_extent * std::max(widest, widest_);
  double largest = 0;
  for (int a = 0; a < shape_.n; ++a) {
    double change = 0;
    for (int k = a * s; k < (a + 1) * s; ++k) change = std::max(change, std::abs(correction_[k]));
    const double extent = std::max({extent_[a], least_extent * largest_[a], negligible});
    if (!std::isfinite(change) || !std::isfinite(extent)) return {INFINITY, INFINITY};
    largest = std::max(largest, change);
    if (change == 0) continue;
    step.by_extent = std::max(step.by_extent, change / extent);
    step.by_value = std::max(step.by_value, change / (extent + std::abs(q_[a])));
  }
  step.leaps = widest_ > 0 && largest > widest_;
  // Coordinates that move by the roundoff of others never settle by themselves.
  if (largest > 0) step.by_value = std::min(step.by_value, largest / widest);
  return step;
}

/// Whether the correction is what roundings of momenta and forces make it. A force at the end of the element,
/// which the equations of its start are without, is the difference of its sums.
bool ElementSolver::within_roundings(const MotionState& state) {
  const int s = shape_.s;
  const AlignedDoubles correction = correction_, residuals = residuals_;
  for (int a = 0; a < shape_.n; ++a)
    std::fill_n(&residuals_[a * s], s, unit_roundoff * (std::abs(state.p[a].high) + std::abs(force_[a])));
  correct();
  bool within = true;
  for (int k = 0; k < size_ && within; ++k)
    within = std::abs(correction[k]) <= roundings_of_step * std::abs(correction_[k]);
  correction_ = correction;
  residuals_ = residuals;
  return within;
}

ElementSolver::Result ElementSolver::solve(const MotionState& state, double h) {
  if (!kinetic_) return iterate(state, h);
  const std::vector<double> guess = x_;
  const Result result = iterate(state, h);
  if (result == Result::solved) return result;
  x_ = guess;
  kinetic_ = false;
  const Result direct = iterate(state, h);
  kinetic_ = ++kinetic_failures_ < most_kinetic_failures;
  return direct;
}

ElementSolver::Result ElementSolver::iterate(const MotionState& state, double h) {
  for (int a = 0; a < shape_.n; ++a) q_[a] = state.q[a].high;
  double before = INFINITY;
  bool leapt = false;
  bool renew = !kinetic_ && !(factored_ && reuse_ && h == factored_h_ && size_ > few_unknowns);
  const double stagnant_at = kinetic_ ? kinetic_stagnation : stagnation;
  if (kinetic_) factored_h_ = h;
  const double negligible = push_ <= weak_force ? weak_factor * negligible_step : negligible_step;
  reuse_ = true;
  wandered_ = false;
  for (steps_ = 1; steps_ <= (kinetic_ ? most_cheap_steps : most_steps); ++steps_) {
    const bool fresh = renew;
    if (!evaluate(state, h, renew ? Order::hessian : Order::gradient)) {
      factored_ = false;
      return Result::not_finite;
    }
    if (renew && !factor(h)) return Result::singular;
    renew = false;
    correct();
    const auto [step, by_value, leaps] = measure();
    if (step == INFINITY) {
      factored_ = false;
      return Result::not_finite;
    }
    const bool small = step <= small_step || by_value <= roundings, stagnant = step >= stagnant_at * before;
    if (step <= negligible || (small && stagnant) || (stagnant && within_roundings(state))) {
      residual_ = 0;
      for (int k = 0; k < size_; ++k) residual_ = std::max(residual_, std::abs(residuals_[k]));
      double force = 0, momentum = 0;
      for (int a = 0; a < shape_.n; ++a) {
        largest_[a] = std::max(largest_[a], extent_[a]);
        widest_ = std::max(widest_, extent_[a]);
        force = std::max(force, std::abs(force_[a]));
        momentum = std::max(momentum, std::abs(state.p[a].high));
      }
      momentum_ = std::max(momentum_, momentum);
      push_ = std::max(push_, force / momentum_);
      return Result::solved;
    }
    const double contraction = step / before;
    if (kinetic_ && !(step < divergence)) return Result::not_converged;
    // Of explicit schemes the equations are linear, and one step solves them.
    wandered_ = wandered_ || (step > near && contraction > (kinetic_ ? 1 : straight)) ||
                (leapt && contraction > linear);
    leapt = leaps;
    if (steps_ == 2 && contraction > good_contraction) reuse_ = false;
    // Far from the solution, a matrix is worth a new one wherever it shrinks steps little.
    if (steps_ > 1 && contraction > poor_contraction && step > small_step) renew = true;
    if (fresh && steps_ == 1) renew = step > poor_contraction;
    if (kinetic_) renew = false;
    before = step;
  }
  factored_ = false;
  return Result::not_converged;
}

double ElementSolver::action_of(const MotionState& state, std::span<const double> x, double h) {
  for (int a = 0; a < shape_.n; ++a) q_[a] = state.q[a].high;
  std::copy(x.begin(), x.end(), x_.begin());
  evaluate(state, h, Order::gradient);
  return action_;
}

void ElementSolver::advance(MotionState& state, double time) const {
  const int s = shape_.s;
  for (int a = 0; a < shape_.n; ++a) {
    state.q[a].add(x_[a * s + s - 1]);
    state.p[a].add(force_[a]);
  }
  state.time = time;
}

}  // namespace extremal
