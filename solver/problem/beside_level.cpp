#include "problem/beside_level.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

/// QD prints a complaint where there is no logarithm.
DoubleDouble power(const DoubleDouble& x, double e) {
  return x > 0.0 && std::isfinite(to_double(x)) ? pow(x, DoubleDouble(e))
                                                : DoubleDouble(std::pow(to_double(x), e));
}

BesideLevel::BesideLevel(const Lagrangian& lagrangian, int coordinate, double level, double side)
    : lagrangian_(lagrangian),
      hessian_(dynamic_cast<const ExtendedHessian*>(&lagrangian)),
      n_(lagrangian.structure().coordinates),
      a_(coordinate),
      level_(level),
      side_(side),
      q_(n_),
      v_(n_),
      rows_(lagrangian.rows(Order::hessian)) {
  for (std::vector<DoubleDouble>* part : {&values_.q, &values_.v}) part->resize(n_);
  for (std::vector<DoubleDouble>* part : {&values_.qq, &values_.vq, &values_.vv}) part->resize(n_ * n_);
}

double BesideLevel::rounded(double distance) const {
  if (extended() || level_ == 0) return distance;
  const double there = side_ * ((level_ + side_ * distance) - level_);
  return there > 0 ? there : distance;
}

const BesideLevel::Values& BesideLevel::at(double distance, std::span<const double> q,
                                           std::span<const double> v, const DoubleDouble& t, Order order) {
  std::ranges::copy(q, q_.begin());
  std::ranges::copy(v, v_.begin());
  distance_ = distance;
  if (a_ >= 0) q_[a_] = DoubleDouble(level_) + side_ * distance_;
  t_ = t;
  if (!hessian_) {
    read_doubles(order);
  } else {
    if (order == Order::hessian)
      hessian_->evaluate_hessian(q_.data(), v_.data(), t, rows_.data(), scratch_);
    else
      lagrangian_.evaluate_extended(q_.data(), v_.data(), t, rows_.data(), scratch_);
    read_rows(order);
    add_quadratic_part();
  }
  return values_;
}

void BesideLevel::read_doubles(Order order) {
  std::vector<double> q(n_), v(n_);
  std::ranges::transform(q_, q.begin(), [](const DoubleDouble& x) { return to_double(x); });
  std::ranges::transform(v_, v.begin(), [](const DoubleDouble& x) { return to_double(x); });
  const PointValues at = evaluate_at(lagrangian_, q, v, to_double(t_), order, double_scratch_);
  values_.value = at.value;
  std::ranges::copy(at.dq, values_.q.begin());
  std::ranges::copy(at.dv, values_.v.begin());
  std::ranges::copy(at.qq, values_.qq.begin());
  std::ranges::copy(at.vq, values_.vq.begin());
  std::ranges::copy(at.vv, values_.vv.begin());
}

void BesideLevel::read_rows(Order order) {
  const Structure& s = lagrangian_.structure();
  for (std::vector<DoubleDouble>* part : {&values_.q, &values_.v, &values_.qq, &values_.vq, &values_.vv})
    std::ranges::fill(*part, DoubleDouble(0));
  const DoubleDouble* row = rows_.data();
  values_.value = *row++;
  for (const std::size_t z : s.gradient) (z < n_ ? values_.q[z] : values_.v[z - n_]) = *row++;
  if (order != Order::hessian) return;
  for (const auto [z, y] : s.hessian) {
    const std::size_t a = z, b = y;
    const DoubleDouble& h = *row++;
    if (a < n_)
      values_.qq[a * n_ + b] = values_.qq[b * n_ + a] = h;
    else if (b < n_)
      values_.vq[(a - n_) * n_ + b] = h;
    else
      values_.vv[(a - n_) * n_ + b - n_] = values_.vv[(b - n_) * n_ + a - n_] = h;
  }
}

/// Which the rows leave out.
void BesideLevel::add_quadratic_part() {
  const Structure& s = lagrangian_.structure();
  for (const Triplet& m : s.mass) {
    values_.value += 0.5 * m.value * v_[m.row] * v_[m.column];
    values_.v[m.row] += m.value * v_[m.column];
    values_.vv[m.row * n_ + m.column] += m.value;
  }
  for (const Triplet& c : s.gyroscopic) {
    values_.value += c.value * v_[c.row] * q_[c.column];
    values_.v[c.row] += c.value * q_[c.column];
    values_.q[c.column] += c.value * v_[c.row];
    values_.vq[c.row * n_ + c.column] += c.value;
  }
  for (std::size_t b = 0; b < s.linear.size(); ++b) {
    values_.value += s.linear[b] * v_[b];
    values_.v[b] += s.linear[b];
  }
}

/// With d' = ± q': dF/dt = C' f + C f' d', where f' = d^−γ. C changes by x² (3 − 2x), x = t/T.
const BesideLevel::Values& BesideLevel::without(const LevelGauge& gauge) {
  if (a_ < 0) return values_;
  const double g = gauge.exponent;
  const DoubleDouble change = gauge.end - gauge.start, x = t_ / gauge.duration,
                     c = gauge.start + change * x * x * (3.0 - 2.0 * x),
                     rate = change * 6.0 * x * (1.0 - x) / gauge.duration, f1 = power(distance_, -g),
                     f0 = f1 * distance_ / (1 - DoubleDouble(g)), f2 = -g * f1 / distance_,
                     f3 = -(1 + DoubleDouble(g)) * f2 / distance_, v = side_ * v_[a_];
  const std::size_t aa = a_ * (n_ + 1);
  values_.value -= rate * f0 + c * f1 * v;
  values_.q[a_] -= side_ * (rate * f1 + c * f2 * v);
  values_.v[a_] -= side_ * c * f1;
  values_.qq[aa] -= rate * f2 + c * f3 * v;
  values_.vq[aa] -= c * f2;
  return values_;
}

double BesideLevel::energy() const {
  DoubleDouble sum = -values_.value;
  for (std::size_t b = 0; b < n_; ++b) sum += values_.v[b] * v_[b];
  return to_double(sum);
}

}  // namespace extremal
