#include "motion/point.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

PointEvaluator::PointEvaluator(const Lagrangian& lagrangian) : lagrangian_(lagrangian) {
  const Structure& s = lagrangian.structure();
  const std::size_t inputs = 2 * s.coordinates + 1;
  point_ = storage_.reserve((inputs + lagrangian.rows(Order::hessian)) * lanes_);
  out_ = point_ + inputs * lanes_;
  dq_.resize(s.coordinates);
  dv_.resize(s.coordinates);
  vq_ = s.gyroscopic;
  vv_ = s.mass;
  const int n = s.coordinates;
  for (const auto& [row, column] : s.hessian) {
    auto& block = row < n ? qq_ : column < n ? vq_ : vv_;
    const int i = row < n ? row : row - n, j = column < n ? column : column - n;
    block.push_back({i, j, 0.0});
    if ((row < n) == (column < n) && i != j) block.push_back({j, i, 0.0});
  }
}

bool PointEvaluator::evaluate(std::span<const double> q, std::span<const double> v, double t, Order order) {
  const std::size_t n = dq_.size();
  for (std::size_t a = 0; a < n; ++a) {
    std::fill_n(point_ + a * lanes_, lanes_, q[a]);
    std::fill_n(point_ + (n + a) * lanes_, lanes_, v[a]);
  }
  double* const times = point_ + 2 * n * lanes_;
  std::fill_n(times, lanes_, t);
  lagrangian_.evaluate({lanes_, lanes_, point_, point_ + n * lanes_, times}, order, out_, scratch_);
  return read_gradient(q, v) && (order != Order::hessian || read_hessian());
}

bool PointEvaluator::read_gradient(std::span<const double> q, std::span<const double> v) {
  const Structure& s = lagrangian_.structure();
  std::fill(dq_.begin(), dq_.end(), 0.0);
  std::fill(dv_.begin(), dv_.end(), 0.0);
  for (const Triplet& m : s.mass) dv_[m.row] += m.value * v[m.column];
  for (const Triplet& c : s.gyroscopic) {
    dv_[c.row] += c.value * q[c.column];
    dq_[c.column] += c.value * v[c.row];
  }
  for (std::size_t a = 0; a < s.linear.size(); ++a) dv_[a] += s.linear[a];
  for (std::size_t k = 0; k < s.gradient.size(); ++k) {
    const auto z = static_cast<std::size_t>(s.gradient[k]);
    (z < dq_.size() ? dq_[z] : dv_[z - dq_.size()]) += out_[(1 + k) * lanes_];
  }
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(dq_.begin(), dq_.end(), finite) && std::all_of(dv_.begin(), dv_.end(), finite);
}

/// The entries stand in the order in which the constructor listed them, after the constant ones.
bool PointEvaluator::read_hessian() {
  const Structure& s = lagrangian_.structure();
  const int n = s.coordinates;
  const double* const rows = out_ + (1 + s.gradient.size()) * lanes_;
  std::size_t in_qq = 0, in_vq = s.gyroscopic.size(), in_vv = s.mass.size();
  bool finite = true;
  for (std::size_t k = 0; k < s.hessian.size(); ++k) {
    const auto [row, column] = s.hessian[k];
    const double value = rows[k * lanes_];
    finite = finite && std::isfinite(value);
    auto& block = row < n ? qq_ : column < n ? vq_ : vv_;
    std::size_t& next = row < n ? in_qq : column < n ? in_vq : in_vv;
    block[next++].value = value;
    if ((row < n) == (column < n) && row != column) block[next++].value = value;
  }
  return finite;
}

}  // namespace extremal
