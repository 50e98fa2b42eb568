#include "motion/dop853.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/dop853_steps.hpp"
#include "motion/dop853_tableau.hpp"

namespace extremal {

namespace {

int controlled_size(const IntegrationOptions& options, int size) {
  return options.controlled > 0 ? std::min(options.controlled, size) : size;
}

int block_size(const IntegrationOptions& options, int size) {
  return options.block > 0 ? options.block : size;
}

template <class T>
T largest(std::span<const T> y, int begin, int end) {
  T found = 0;
  for (int i = begin; i < end; ++i) found = std::max(found, std::abs(y[i]));
  return found;
}

}  // namespace

template <class T>
DormandPrince<T>::DormandPrince(RightHandSide<T> right_hand_side, int size)
    : slope_(std::move(right_hand_side)),
      size_(size),
      k_(static_cast<std::size_t>(dop853::interpolating_stages) * size),
      stage_(size),
      next_(size),
      last_y_(size) {}

template <class T>
bool DormandPrince<T>::step(T t, std::span<const T> y, T h) {
  const auto k = [this](int i) { return std::span<T>(k_).subspan(i * size_, size_); };
  const auto combine = [&](const dop853::Row<T>& row, int count, std::vector<T>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    for (int j = 0; j < count; ++j)
      if (row[j] != 0)
        for (int m = 0; m < size_; ++m) out[m] += row[j] * k_[j * size_ + m];
    for (int m = 0; m < size_; ++m) out[m] = y[m] + h * out[m];
  };
  for (int i = 0; i < dop853::stages; ++i) {
    combine(dop853::a<T>[i], i, stage_);
    if (!slope_(t + dop853::c<T>[i] * h, stage_, k(i))) return false;
  }
  combine(dop853::b<T>, dop853::stages, next_);
  return std::all_of(next_.begin(), next_.end(), [](T x) { return std::isfinite(x); });
}

template <class T>
T DormandPrince<T>::error_norm(std::span<const T> y, T h, const IntegrationOptions& options) const {
  const int size = controlled_size(options, size_), block = block_size(options, size);
  T sum5 = 0, sum3 = 0;
  for (int begin = 0; begin < size; begin += block) {
    const int end = std::min(begin + block, size);
    const T least = options.least[(begin / block) % 2];
    const T scale =
        std::max({largest(y, begin, end), largest<T>(next_, begin, end), least}) * options.tolerance;
    if (scale == 0) continue;
    for (int m = begin; m < end; ++m) {
      T e5 = 0, e3 = 0;
      for (int i = 0; i < dop853::stages; ++i) {
        e5 += dop853::error5<T>[i] * k_[i * size_ + m];
        e3 += dop853::error3<T>[i] * k_[i * size_ + m];
      }
      sum5 += (e5 / scale) * (e5 / scale);
      sum3 += (e3 / scale) * (e3 / scale);
    }
  }
  return dop853::error_norm(sum5, sum3, h, size);
}

/// A hundredth of the time in which a block would change by its own size, but where that is all but zero, as
/// at rest; the control does the rest.
template <class T>
T DormandPrince<T>::first_step(T t, std::span<const T> y, T span, const IntegrationOptions& options) {
  T h = std::abs(span);
  if (!slope_(t, y, stage_)) return std::copysign(h, span);
  const int size = controlled_size(options, size_), block = block_size(options, size);
  for (int begin = 0; begin < size; begin += block) {
    const int end = std::min(begin + block, size);
    const T value = largest(y, begin, end), slope = largest<T>(stage_, begin, end);
    if (value > 0 && slope > 0) h = std::min(h, dop853::first_change * value / slope);
  }
  h = std::max(h, dop853::shortest_start * std::abs(span));
  return std::copysign(h, span);
}

template <class T>
Integrated DormandPrince<T>::accept_step(T& t, std::span<T> y, T end, const IntegrationOptions& options) {
  const T least = 4 * std::numeric_limits<T>::epsilon() * std::abs(t);
  // Too short a step is what an end close by has left behind.
  if (std::abs(h_) <= least || (end - t) * h_ < 0) h_ = first_step(t, y, end - t, options);
  for (bool after_rejection = false;; after_rejection = true) {
    if (options.deadline.passed()) return Integrated::deadline;
    const bool last = std::abs(end - t) <= std::abs(h_) * (1 + 1e-12);
    const T h = last ? end - t : h_;
    if (!last && std::abs(h_) <= least) return Integrated::step_underflow;
    if (!step(t, y, h)) {
      h_ = h * dop853::retreat;
      if (t + h_ == t) return Integrated::step_underflow;
      ++rejected_;
      continue;
    }
    const T error = error_norm(y, h, options);
    const T factor = dop853::growth(error);
    if (error > 1) {
      h_ = h * std::min<T>(factor, dop853::safety);
      ++rejected_;
      continue;
    }
    const T proposed = h * (after_rejection ? std::min<T>(factor, 1) : factor);
    // A step cut off at the end says nothing against the longer one that was planned.
    h_ = last && std::abs(proposed) < std::abs(h_) ? h_ : proposed;
    std::copy(y.begin(), y.end(), last_y_.begin());
    last_t_ = t;
    last_h_ = h;
    t = last ? end : t + h;
    std::copy(next_.begin(), next_.end(), y.begin());
    ++steps_;
    return Integrated::done;
  }
}

template <class T>
Integrated DormandPrince<T>::advance(T& t, std::span<T> y, T end, const IntegrationOptions& options) {
  for (int taken = 0; t != end; ++taken) {
    if (taken == options.max_steps) return Integrated::step_limit;
    const Integrated outcome = accept_step(t, y, end, options);
    if (outcome != Integrated::done) return outcome;
  }
  return Integrated::done;
}

/// Hairer, Nørsett and Wanner, II.6: q0 + θ (f0 + (1 − θ) (f1 + θ (f2 + …))).
template <class T>
bool DormandPrince<T>::prepare_interpolation(std::span<const T> y, int components) {
  const auto k = [&](int i) { return std::span<T>(k_).subspan(std::size_t(i) * size_, components); };
  if (!slope_(last_t_ + last_h_, y.first(components), k(dop853::stages))) return false;
  for (int i = 0; i < 3; ++i) {
    for (int m = 0; m < components; ++m) {
      T sum = 0;
      for (int j = 0; j <= dop853::stages + i; ++j)
        sum += dop853::more_a<T>[i][j] * k_[std::size_t(j) * size_ + m];
      stage_[m] = last_y_[m] + last_h_ * sum;
    }
    const T t = last_t_ + dop853::more_c<T>[i] * last_h_;
    if (!slope_(t, std::span(stage_).first(components), k(dop853::stages + 1 + i))) return false;
  }
  shape_.assign(std::size_t(7) * components, 0.0);
  for (int m = 0; m < components; ++m) {
    T* const shape = shape_.data() + std::size_t(7) * m;
    const T delta = y[m] - last_y_[m], first = last_h_ * k_[m], last = last_h_ * k(dop853::stages)[m];
    shape[0] = delta;
    shape[1] = first - delta;
    shape[2] = 2 * delta - (first + last);
    for (int r = 0; r < 4; ++r)
      for (int i = 0; i < dop853::interpolating_stages; ++i)
        shape[3 + r] += last_h_ * dop853::d<T>[r][i] * k_[std::size_t(i) * size_ + m];
  }
  return true;
}

template <class T>
void DormandPrince<T>::interpolate(T theta, std::span<T> y) const {
  for (std::size_t m = 0; m < y.size(); ++m) {
    const T* const shape = shape_.data() + std::size_t(7) * m;
    T value = 0;
    for (int r = 6; r >= 0; --r) value = (value + shape[r]) * (r % 2 == 0 ? theta : 1 - theta);
    y[m] = last_y_[m] + value;
  }
}

template class DormandPrince<double>;
template class DormandPrince<long double>;

}  // namespace extremal
