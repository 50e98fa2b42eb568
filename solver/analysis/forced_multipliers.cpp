#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/multipliers.hpp"
#include "analysis/symplectic.hpp"
#include "linear/dense.hpp"
#include "machine/roundoff.hpp"

/// \file Floquet multipliers of orbits of systems with forces. The second variation of two copies,
///   u = (q₁ + q₂)/2 and λ = q₁ − q₂, has in (u, λ) the form 2 λᵀA u: the linearised equations of motion.

namespace extremal {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Of the shift in time after a part of the orbit.
constexpr double known_shift = 0.1;
/// Growth within a group of columns whose block is formed: log of a factor by which it may cost accuracy.
const double most_spread = std::log(1e4);
/// Leading columns are mapped into themselves within this.
constexpr double invariant_within = 1e-13;
constexpr int most_passes = 64;

/// Rows of λ and columns of u of a form of both copies: exchanging these changes its sign.
MatrixXd linearised(const Eigen::Ref<const MatrixXd>& form) {
  const auto n = form.rows() / 2;
  return form.topLeftCorner(n, n) + form.topRightCorner(n, n);
}

/// From (q, p) at the start of a piece to its end: as transfer(), of forms that are not symmetric. By λ_a the
/// action of two copies has the derivative −p_a, by λ_b p_b.
MatrixXd motion_transfer(const Piece& piece, const VectorXd& unit) {
  const auto n = piece.a.rows() / 2;
  const VectorXd inverse = unit.cwiseInverse();
  const auto scaled = [&](const MatrixXd& form) -> MatrixXd {
    return inverse.asDiagonal() * linearised(form) * inverse.asDiagonal();
  };
  MatrixXd result(2 * n, 2 * n);
  result.topLeftCorner(n, n) = scaled(piece.a);
  result.topRightCorner(n, n).setIdentity();
  result.topRows(n) = solved(-scaled(piece.b.transpose()), result.topRows(n));
  result.bottomRows(n) = scaled(piece.d) * result.topRows(n);
  result.bottomLeftCorner(n, n) += scaled(piece.b);
  return result;
}

/// What a crossing does to (q, p) of a motion beside, and the field of the shift in time after it.
struct Saltation {
  MatrixXd matrix;
  VectorXd shift;
};

/// Where a force jumps at u(q, q', t) = 0, a motion y = (q, p) beside another, δy, crosses later by
/// δt = −∇u·δy/u', and until then has the slope f₋ in place of f₊:
///   δy₊ = (I + (f₊ − f₋) ∇uᵀ/u') δy₋,   u' by f₋.
/// Of f = (q', p') the second half jumps alone, and δq' = L_vv⁻¹(δp − L_vq δq).
Saltation saltation(const Lagrangian& copies, const Switch& at, double length, const VectorXd& unit) {
  const auto n = unit.size();
  Scratch memory;
  const auto evaluate = [&](double u, double time, Order order) {  // on the side before
    return evaluate_at(copies, at.q, at.velocity_at(u * at.before), time, order, memory);
  };
  // Second derivatives of a force lose digits beside its jump.
  constexpr double near = 0x1p-40, apart = 0x1p-20;
  const PointValues first = evaluate(near, at.t, Order::gradient),
                    second = evaluate(apart, at.t, Order::hessian);
  const auto one = [&](const std::vector<double>& both) -> MatrixXd {
    return linearised(Eigen::Map<const RowMajor>(both.data(), 2 * n, 2 * n));
  };
  const auto sum = [&](const std::vector<double>& both) -> VectorXd {
    return VectorXd::Map(both.data(), n) + VectorXd::Map(both.data() + n, n);
  };
  const auto half = [&](const std::vector<double>& both) { return VectorXd::Map(both.data(), n); };
  // ∂p/∂t at given q and q'.
  const double step = std::cbrt(machine_epsilon) * length;
  const PointValues earlier = evaluate(near, at.t - step, Order::gradient),
                    later = evaluate(near, at.t + step, Order::gradient);
  const VectorXd drift = (half(later.dv) - half(earlier.dv)) / (2 * step);
  const VectorXd by_p = solved(one(second.vv).transpose(), sum(at.by_v));
  const VectorXd by_q = sum(at.by_q) - one(second.vq).transpose() * by_p;
  const double rate = at.by_t + by_q.dot(half(at.v)) + by_p.dot(half(first.dq) - drift);
  const VectorXd inverse = unit.cwiseInverse(), jump = inverse.asDiagonal() * half(at.jump);
  Saltation result{MatrixXd::Identity(2 * n, 2 * n), VectorXd(2 * n)};
  result.matrix.bottomLeftCorner(n, n) += jump / rate * (inverse.asDiagonal() * by_q).transpose();
  result.matrix.bottomRightCorner(n, n) += jump / rate * (unit.asDiagonal() * by_p).transpose();
  result.shift << unit.asDiagonal() * half(at.v), inverse.asDiagonal() * half(first.dq) + jump;
  return result;
}

/// The field of the shift in time at the start of piece k, of one copy.
VectorXd shift_of_one(const SecondVariation& variation, int k, const VectorXd& unit) {
  const auto n = unit.size();
  const VectorXd both = variation.shift(k);
  VectorXd field(2 * n);
  field << unit.asDiagonal() * both.head(n), unit.cwiseInverse().asDiagonal() * both.segment(2 * n, n);
  return field;
}

/// The flow over the pieces, and R⁻¹ after the last; across the shift in time where it is known along the
/// whole orbit.
struct Factors {
  std::vector<MatrixXd> flow;
  bool shifted = false;
};

Factors factors_of(const SecondVariation& variation, const ClosedOrbit& orbit) {
  const int n = variation.coordinates() / 2, count = variation.count();
  const VectorXd unit = symplectic_units(variation).head(n);
  Factors result;
  std::vector<VectorXd> shifts;
  for (int k = 0; k <= count; ++k) shifts.push_back(shift_of_one(variation, k % count, unit));
  for (int k = 0; k < count; ++k) {
    const Piece piece = variation.piece(k);
    result.flow.push_back(motion_transfer(piece, unit));
    for (const Switch& at : variation.switches_after(k)) {
      const Saltation crossing = saltation(variation.lagrangian(), at, piece.length, unit);
      result.flow.back() = (crossing.matrix * result.flow.back()).eval();
      shifts[k + 1] = crossing.shift;
    }
  }
  if (orbit.map.size() > 0) {
    const MatrixXd map = orbit.map.topLeftCorner(n, n);
    const MatrixXd scaled = unit.asDiagonal() * map * unit.cwiseInverse().asDiagonal();
    MatrixXd& last = result.flow.back();
    last.topRows(n) = solved(scaled, last.topRows(n));
    last.bottomRows(n) = (scaled.transpose() * last.bottomRows(n)).eval();
    shifts.back() = shifts.front();
  } else {
    shifts.front() = shifts.back();
  }
  result.shifted = orbit.autonomous;
  for (int k = 0; k < count && result.shifted; ++k) {
    const double size = shifts[k + 1].norm();
    result.shifted = size > 0 && (result.flow[k] * shifts[k] - shifts[k + 1]).norm() <= known_shift * size;
  }
  if (!result.shifted) return result;
  std::vector<MatrixXd> across;
  for (const VectorXd& shift : shifts) across.push_back(complement(shift));
  for (int k = 0; k < count; ++k)
    result.flow[k] = (across[k + 1].transpose() * result.flow[k] * across[k]).eval();
  return result;
}

/// Eigenvalues of a product of factors by orthogonal iteration through them: leading columns become invariant
/// where the growth drops, and each group of columns has a block of its own, so that small multipliers are as
/// good as large ones.
class ProductEigenvalues {
 public:
  explicit ProductEigenvalues(const std::vector<MatrixXd>& factors)
      : factors_(factors), n_(factors.front().rows()), triangles_(factors.size()) {
    MatrixXd start(n_, n_);
    for (Eigen::Index i = 0; i < start.size(); ++i) start.data()[i] = std::cos(1 + 2.4 * i);
    after_ = orthonormal(start);
  }

  std::vector<Complex> run() {
    for (int sweep = 0; sweep < most_passes; ++sweep) {
      pass();
      find_groups();
      if (sweep > 0 && moderate()) break;
    }
    std::vector<Complex> values;
    for (std::size_t g = 0; g + 1 < first_.size(); ++g) add_group(first_[g], first_[g + 1], values);
    return values;
  }

 private:
  void pass() {
    before_ = after_;
    growth_.setZero(n_);
    for (std::size_t k = 0; k < factors_.size(); ++k) {
      const Eigen::HouseholderQR<MatrixXd> qr(factors_[k] * after_);
      after_ = qr.householderQ();
      triangles_[k] = qr.matrixQR().triangularView<Eigen::Upper>();
      growth_ += triangles_[k].diagonal().cwiseAbs().array().max(1e-300).log().matrix();
    }
    shift_ = before_.transpose() * after_;
  }

  void find_groups() {
    first_.assign(1, 0);
    for (Eigen::Index u = 1; u < n_; ++u)
      if (shift_.bottomLeftCorner(n_ - u, u).cwiseAbs().maxCoeff() <= invariant_within) first_.push_back(u);
    first_.push_back(n_);
  }

  bool moderate() const {
    for (std::size_t g = 0; g + 1 < first_.size(); ++g) {
      const auto growth = growth_.segment(first_[g], first_[g + 1] - first_[g]);
      if (growth.maxCoeff() - growth.minCoeff() > most_spread) return false;
    }
    return true;
  }

  void add_group(Eigen::Index from, Eigen::Index to, std::vector<Complex>& values) const {
    const Eigen::Index count = to - from;
    MatrixXd block = MatrixXd::Identity(count, count);
    double scale = 0;  // log
    for (const MatrixXd& triangle : triangles_) {
      block = (triangle.block(from, from, count, count) * block).eval();
      const double size = block.cwiseAbs().maxCoeff();
      if (!(size > 0)) break;
      block /= size;
      scale += std::log(size);
    }
    block = (shift_.block(from, from, count, count) * block).eval();
    for (const Complex& value : general_eigenvalues(block)) values.push_back(value * std::exp(scale));
  }

  const std::vector<MatrixXd>& factors_;
  const Eigen::Index n_;
  std::vector<MatrixXd> triangles_;
  MatrixXd before_, after_, shift_;
  VectorXd growth_;  ///< log, of each column in the last pass
  std::vector<Eigen::Index> first_;
};

}  // namespace

std::optional<Floquet> floquet_with_forces(const SecondVariation& variation, const ClosedOrbit& orbit) {
  const Factors factors = factors_of(variation, orbit);
  for (const MatrixXd& factor : factors.flow)
    if (!factor.allFinite()) return std::nullopt;
  Floquet result;
  result.paired = false;
  if (factors.flow.front().size() > 0) result.multipliers = ProductEigenvalues(factors.flow).run();
  if (factors.shifted) result.multipliers.emplace_back(1.0);
  for (const Complex& value : result.multipliers)
    if (!std::isfinite(std::abs(value))) return std::nullopt;
  sort_multipliers(result);
  return result;
}

}  // namespace extremal
