#include "action/extended.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

/// Tables of the rule and the basis in extended precision; those there are stay.
bool ExtendedGradient::bind(const SchemeTables& scheme) {
  const bool gauss = scheme.scheme.quadrature == Quadrature::gauss;
  if (!gauss && !scheme.nodal) return false;
  if (degree_ == scheme.degree && points_ == scheme.points && quadrature_ == scheme.scheme.quadrature)
    return true;
  degree_ = scheme.degree;
  points_ = scheme.points;
  quadrature_ = scheme.scheme.quadrature;
  rule_ = gauss ? real_gauss(points_) : real_lobatto(points_);
  const RealElement& element = real_element(degree_);
  const std::size_t count = degree_ + 1;
  value_.resize(points_ * count);
  slope_.resize(value_.size());
  for (int i = 0; i < points_; ++i) {
    const std::span<Real> value(value_.data() + i * count, count), slope(slope_.data() + i * count, count);
    const int node = node_at(element, rule_.nodes[i]);
    values_at(element, rule_.nodes[i], node, value);
    derivatives_at(element, rule_.nodes[i], node, value, slope);
  }
  return true;
}

/// q, q' and t at point i of element k.
void ExtendedGradient::place(const Path& path, int k, int i, Real h) {
  const double* x = path.x(k / lanes) + k % lanes;
  const Real *value = value_.data() + static_cast<std::size_t>(i) * (degree_ + 1),
             *slope = slope_.data() + static_cast<std::size_t>(i) * (degree_ + 1);
  const Real tau = rule_.nodes[i].left;
  for (int a = 0; a < n_; ++a) {
    const Real delta =
        (Real(path.node(k + 1)[a]) - path.node(k)[a]) + (Real(path.rest(k + 1)[a]) - path.rest(k)[a]);
    Real chord = tau * delta, rate = delta;
    for (int j = 1; j < degree_; ++j) {
      const Real deviation = x[((j - 1) * n_ + a) * lanes];
      chord += value[j] * deviation;
      rate += slope[j] * deviation;
    }
    q_[a] = path.node(k)[a] + (chord + path.rest(k)[a]);
    v_[a] = rate / h;
  }
  const std::span<const double> mesh = path.mesh();
  t_ = (mesh[k] + tau * (Real(mesh[k + 1]) - mesh[k])) * path.duration();
}

/// L from its remainder, returned, L_q and L_q'.
Real ExtendedGradient::differentiate(const Structure& structure) {
  std::fill(force_.begin(), force_.end(), Real(0));
  std::fill(momentum_.begin(), momentum_.end(), Real(0));
  Real lagrangian = rows_[0];
  for (const Triplet& m : structure.mass) {
    momentum_[m.row] += m.value * v_[m.column];
    lagrangian += m.value * v_[m.row] * v_[m.column] / 2;
  }
  for (const Triplet& c : structure.gyroscopic) {
    momentum_[c.row] += c.value * q_[c.column];
    force_[c.column] += c.value * v_[c.row];
    lagrangian += c.value * v_[c.row] * q_[c.column];
  }
  for (std::size_t a = 0; a < structure.linear.size(); ++a) {
    momentum_[a] += structure.linear[a];
    lagrangian += structure.linear[a] * v_[a];
  }
  for (std::size_t g = 0; g < structure.gradient.size(); ++g) {
    const int z = structure.gradient[g];
    (z < n_ ? force_[z] : momentum_[z - n_]) += rows_[1 + g];
  }
  return lagrangian;
}

/// ∂L_d/∂x of every unknown; L_d = h Σ b_i L_i with q' = (…)/h gives ∂L_d/∂h = Σ b_i (L_i − L_q'·q').
void ExtendedGradient::element(const Lagrangian& lagrangian, const Path& path, int k) {
  const Real share = Real(path.mesh()[k + 1]) - path.mesh()[k], h = share * path.duration();
  Real *inner = inner_.data() + static_cast<std::size_t>(k) * width_,
       *node = nodes_.data() + static_cast<std::size_t>(k) * n_;
  std::fill(ends_.begin(), ends_.end(), Real(0));
  for (int i = 0; i < points_; ++i) {
    place(path, k, i, h);
    lagrangian.evaluate_extended(q_.data(), v_.data(), t_, rows_.data(), scratch_);
    const Real value = differentiate(lagrangian.structure()), weight = rule_.weights[i];
    const Abscissa at = rule_.nodes[i];
    Real work = 0;
    for (int a = 0; a < n_; ++a) {
      const Real force = weight * h * force_[a], momentum = weight * momentum_[a];
      work += momentum_[a] * v_[a];
      ends_[a] += at.right * force - momentum;
      ends_[n_ + a] += at.left * force + momentum;
      for (int j = 1; j < degree_; ++j) {
        const std::size_t entry = static_cast<std::size_t>(i) * (degree_ + 1) + j;
        inner[(j - 1) * n_ + a] += value_[entry] * force + slope_[entry] * momentum;
      }
    }
    action_ += weight * h * value;
    slope_duration_ += weight * share * (value - work);
  }
  for (int a = 0; a < 2 * n_; ++a) {
    node[a] += ends_[a];
    momentum_scale_ = std::max(momentum_scale_, std::abs(ends_[a]));
  }
}

bool ExtendedGradient::evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path) {
  n_ = path.coordinates();
  q_.resize(n_);
  v_.resize(n_);
  force_.resize(n_);
  momentum_.resize(n_);
  ends_.resize(2 * static_cast<std::size_t>(n_));
  rows_.resize(lagrangian.rows(Order::gradient));
  if (!bind(tables.scheme()) ||
      !lagrangian.evaluate_extended(q_.data(), v_.data(), 0, rows_.data(), scratch_))
    return false;
  width_ = static_cast<std::size_t>(degree_ - 1) * n_;
  inner_.assign(width_ * path.elements(), 0);
  nodes_.assign(static_cast<std::size_t>(path.elements() + 1) * n_, 0);
  action_ = slope_duration_ = momentum_scale_ = 0;
  for (int k = 0; k < path.elements(); ++k) element(lagrangian, path, k);
  return true;
}

}  // namespace extremal
