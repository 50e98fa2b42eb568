#include "motion/extended_flow.hpp"

#include <qd/dd_real.h>

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

constexpr int most_coordinates = 64;
/// Each gives the digits of a double, less what the condition of M costs.
constexpr int mass_refinements = 3;

double rounded(const Extended& x) { return static_cast<double>(x); }
double rounded(const DoubleDouble& x) { return to_double(x); }

template <class Real>
bool finite(std::span<const Real> x) {
  return std::all_of(x.begin(), x.end(), [](const Real& a) { return std::isfinite(rounded(a)); });
}

}  // namespace

template <class Real>
bool ExtendedFlow<Real>::suits(const Lagrangian& lagrangian) {
  const Structure& structure = lagrangian.structure();
  if (!structure.quadratic || !structure.velocity_free || structure.coordinates > most_coordinates)
    return false;
  const std::vector<Real> at(structure.coordinates, 0.0);
  std::vector<Real> rows(lagrangian.rows(Order::gradient));
  PointScratch<Real> scratch;
  return lagrangian.evaluate_extended(at.data(), at.data(), Real(0.0), rows.data(), scratch);
}

template <class Real>
ExtendedFlow<Real>::ExtendedFlow(const Lagrangian& lagrangian)
    : lagrangian_(lagrangian),
      structure_(lagrangian.structure()),
      hessian_(dynamic_cast<const ExtendedHessian*>(&lagrangian)),
      part_(structure_.coordinates),
      rows_(lagrangian.rows(Order::gradient)),
      rest_(structure_.coordinates) {
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(structure_.coordinates, structure_.coordinates);
  for (const Triplet& m : structure_.mass) mass(m.row, m.column) += m.value;
  mass_.compute(mass);
  if (mass.isDiagonal(0)) diagonal_.assign(mass.diagonal().begin(), mass.diagonal().end());
}

template <class Real>
bool ExtendedFlow<Real>::momentum(std::span<const Real> q, std::span<const Real> v, Real,
                                  std::span<Real> p) const {
  std::fill(p.begin(), p.end(), 0.0);
  for (const Triplet& m : structure_.mass) p[m.row] += m.value * v[m.column];
  for (const Triplet& c : structure_.gyroscopic) p[c.row] += c.value * q[c.column];
  for (std::size_t a = 0; a < structure_.linear.size(); ++a) p[a] += structure_.linear[a];
  return finite(std::span<const Real>(p));
}

/// v becomes M⁻¹ v, by refinement of factors in double precision.
template <class Real>
void ExtendedFlow<Real>::solve_mass(std::span<Real> v) {
  if (!diagonal_.empty()) {
    for (std::size_t a = 0; a < v.size(); ++a) v[a] /= diagonal_[a];
    return;
  }
  std::ranges::copy(v, rest_.begin());
  std::fill(v.begin(), v.end(), 0.0);
  for (int pass = 0; pass < mass_refinements; ++pass) {
    std::transform(rest_.begin(), rest_.end(), part_.begin(), [](const Real& x) { return rounded(x); });
    part_ = mass_.solve(part_).eval();
    for (std::size_t a = 0; a < v.size(); ++a) v[a] += part_[a];
    for (const Triplet& m : structure_.mass) rest_[m.row] -= Real(m.value) * part_[m.column];
  }
}

/// M⁻¹ (p − C q − a) for y = (q, p).
template <class Real>
void ExtendedFlow<Real>::velocity(std::span<const Real> y, std::span<Real> v) {
  const std::size_t n = structure_.coordinates;
  std::copy_n(y.begin() + static_cast<std::ptrdiff_t>(n), n, v.begin());
  for (const Triplet& c : structure_.gyroscopic) v[c.row] -= c.value * y[c.column];
  for (std::size_t a = 0; a < structure_.linear.size(); ++a) v[a] -= structure_.linear[a];
  solve_mass(v);
}

/// Cᵀ v.
template <class Real>
void ExtendedFlow<Real>::add_gyroscopic_force(std::span<const Real> v, std::span<Real> force) const {
  for (const Triplet& c : structure_.gyroscopic) force[c.column] += c.value * v[c.row];
}

template <class Real>
bool ExtendedFlow<Real>::slope(Real t, std::span<const Real> y, std::span<Real> slope) {
  const std::size_t n = structure_.coordinates;
  const std::span<Real> v = slope.first(n), force = slope.subspan(n, n);
  velocity(y, v);
  lagrangian_.evaluate_extended(y.data(), v.data(), t, rows_.data(), scratch_);
  std::fill(force.begin(), force.end(), 0.0);
  add_gyroscopic_force(v, force);
  for (std::size_t g = 0; g < structure_.gradient.size(); ++g) force[structure_.gradient[g]] += rows_[1 + g];
  return finite<Real>(slope.first(2 * n));
}

template <class Real>
bool ExtendedFlow<Real>::slope_with_variations(Real t, std::span<const Real> y, std::span<Real> slope) {
  const std::size_t n = structure_.coordinates;
  rows_.resize(lagrangian_.rows(Order::hessian));
  if (!this->slope(t, y, slope)) return false;
  hessian_->evaluate_hessian(y.data(), slope.data(), t, rows_.data(), scratch_);
  const Real* const hessian = rows_.data() + 1 + structure_.gradient.size();
  for (std::size_t begin = 2 * n; begin < y.size(); begin += 2 * n) {
    const auto dq = y.subspan(begin, n), dp = y.subspan(begin + n, n);
    const auto dv = slope.subspan(begin, n), force = slope.subspan(begin + n, n);
    std::copy(dp.begin(), dp.end(), dv.begin());
    for (const Triplet& c : structure_.gyroscopic) dv[c.row] -= c.value * dq[c.column];
    solve_mass(dv);
    std::fill(force.begin(), force.end(), 0.0);
    add_gyroscopic_force(dv, force);
    for (std::size_t e = 0; e < structure_.hessian.size(); ++e) {
      const auto row = static_cast<std::size_t>(structure_.hessian[e].row),
                 column = static_cast<std::size_t>(structure_.hessian[e].column);
      force[row] += hessian[e] * dq[column];
      if (row != column) force[column] += hessian[e] * dq[row];
    }
  }
  return finite<Real>(slope);
}

template class ExtendedFlow<Extended>;
template class ExtendedFlow<DoubleDouble>;

}  // namespace extremal
