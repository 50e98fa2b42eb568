#include "motion/point.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

/// Coordinates a, then velocities n + a, of the first copy, are rows; of all copies columns.
void PointEvaluator::place(int row, int column, double value, int source) {
  const auto n = static_cast<int>(n_), all = static_cast<int>(all_);
  const auto folded = [&](int z) { return (z % all) % n; };
  if (row % all >= n) return;  // the second copy
  const int block = 2 * (row >= all) + (column >= all);
  if (source >= 0) places_.push_back({source, block, second_[block].size()});
  second_[block].push_back({folded(row), folded(column), value});
}

PointEvaluator::PointEvaluator(const Lagrangian& lagrangian, int copies)
    : lagrangian_(lagrangian),
      n_(lagrangian.structure().coordinates / copies),
      all_(lagrangian.structure().coordinates) {
  const Structure& s = lagrangian.structure();
  const std::size_t inputs = 2 * all_ + 1;
  point_ = storage_.reserve((inputs + lagrangian.rows(Order::hessian)) * lanes_);
  out_ = point_ + inputs * lanes_;
  dq_.resize(n_);
  dv_.resize(n_);
  linear_ = s.linear;
  linear_.resize(s.linear.empty() ? 0 : n_);
  const auto all = static_cast<int>(all_);
  for (const Triplet& m : s.mass) place(all + m.row, all + m.column, m.value, -1);
  for (const Triplet& c : s.gyroscopic) {
    place(all + c.row, c.column, c.value, -1);
    place(c.column, all + c.row, c.value, -1);
  }
  for (int block = 0; block < 4; ++block) constant_[block] = second_[block].size();
  for (int k = 0; k < std::ssize(s.hessian); ++k) {
    const auto [row, column] = s.hessian[k];
    place(row, column, 0, k);
    if (row != column) place(column, row, 0, k);
  }
}

bool PointEvaluator::evaluate(std::span<const double> q, std::span<const double> v, double t, Order order) {
  for (std::size_t a = 0; a < all_; ++a) {
    std::fill_n(point_ + a * lanes_, lanes_, q[a % n_]);
    std::fill_n(point_ + (all_ + a) * lanes_, lanes_, v[a % n_]);
  }
  double* const times = point_ + 2 * all_ * lanes_;
  std::fill_n(times, lanes_, t);
  lagrangian_.evaluate({lanes_, lanes_, point_, point_ + all_ * lanes_, times}, order, out_, scratch_);
  return read_gradient(q, v) && (order != Order::hessian || read_hessian());
}

bool PointEvaluator::read_gradient(std::span<const double> q, std::span<const double> v) {
  const Structure& s = lagrangian_.structure();
  std::fill(dq_.begin(), dq_.end(), 0.0);
  std::copy(linear_.begin(), linear_.end(), dv_.begin());
  if (linear_.empty()) std::fill(dv_.begin(), dv_.end(), 0.0);
  const auto add = [&](int block, std::vector<double>& to, std::span<const double> x) {
    for (std::size_t k = 0; k < constant_[block]; ++k) {
      const Triplet& e = second_[block][k];
      to[e.row] += e.value * x[e.column];
    }
  };
  add(1, dq_, v);
  add(2, dv_, q);
  add(3, dv_, v);
  for (std::size_t k = 0; k < s.gradient.size(); ++k) {
    const auto z = static_cast<std::size_t>(s.gradient[k]);
    if (z % all_ < n_) (z < all_ ? dq_ : dv_)[z % all_] += out_[(1 + k) * lanes_];
  }
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(dq_.begin(), dq_.end(), finite) && std::all_of(dv_.begin(), dv_.end(), finite);
}

bool PointEvaluator::read_hessian() {
  const double* const rows = out_ + (1 + lagrangian_.structure().gradient.size()) * lanes_;
  bool finite = true;
  for (const Place& place : places_) {
    const double value = rows[static_cast<std::size_t>(place.source) * lanes_];
    finite = finite && std::isfinite(value);
    second_[place.block][place.at].value = value;
  }
  return finite;
}

}  // namespace extremal
