#include "solve/march/predictor.hpp"

#include <algorithm>
#include <cmath>

#include "solution/element_point.hpp"
#include "solve/march/limits.hpp"
#include "solve/mesh/nodal_values.hpp"

namespace extremal {

using limits::march::most_differences;

UniformMotion::UniformMotion(const StepTables& tables, bool paired)
    : degree_(tables.degree()), copies_(paired ? 2 : 1) {
  if (tables.lagrangian().structure().quadratic) return;
  flow_.emplace(tables.lagrangian(), copies_);
  q_.resize(flow_->coordinates());
  p_.resize(q_.size());
  v_.resize(q_.size());
}

void UniformMotion::predict(const MotionState& state, double h, std::span<double> x) {
  std::fill(x.begin(), x.end(), 0.0);
  for (std::size_t a = 0; a < q_.size(); ++a) {
    q_[a] = state.q[a].high;
    p_[a] = state.p[a].high;
  }
  if (!flow_) return;
  if (!flow_->velocity(q_, p_, state.time, v_)) std::ranges::fill(v_, nearly_at_rest);
  for (std::size_t a = 0; a < v_.size(); ++a)
    for (int copy = 0; copy < copies_; ++copy) x[(copy * v_.size() + a) * degree_ + degree_ - 1] = v_[a] * h;
}

Differences::Differences(int size)
    : size_(size), table_(static_cast<std::size_t>(most_differences + 1) * size, 0.0), work_(size) {}

void Differences::predict(std::span<double> x) const {
  std::copy_n(table_.begin(), size_, x.begin());
  for (int i = 1; i <= order_; ++i) {
    const double* const difference = table_.data() + static_cast<std::size_t>(i) * size_;
    for (int k = 0; k < size_; ++k) x[k] += difference[k];
  }
}

/// ∇^{i+1} x is what the prediction of order i missed x by.
void Differences::add(std::span<const double> x) {
  const int most = std::min(count_, most_differences);
  double least = INFINITY;
  order_ = 0;
  for (int k = 0; k < size_; ++k) work_[k] = x[k];
  for (int i = 0; i <= most; ++i) {
    double* const difference = table_.data() + static_cast<std::size_t>(i) * size_;
    double missed = 0;
    for (int k = 0; k < size_; ++k) {
      const double next = work_[k] - difference[k];
      difference[k] = work_[k];
      work_[k] = next;
      missed = std::max(missed, std::abs(next));
    }
    if (i < most && missed < least) {
      least = missed;
      order_ = i;
    }
  }
  count_ = std::min(count_ + 1, most_differences);
}

PolynomialContinuation::PolynomialContinuation(const StepTables& tables)
    : tables_(tables),
      coefficients_(static_cast<std::size_t>(tables.degree() + 1) * tables.coordinates()),
      values_(coefficients_.size()),
      legendre_(tables.degree() + 1) {}

/// Of P_k(2τ − 1), k by k; of q less that at the start of the element.
void PolynomialContinuation::coefficients(std::span<const double> x) {
  const int n = tables_.coordinates(), s = tables_.degree();
  const std::vector<double>& legendre = tables_.scheme().legendre;
  for (int k = 0; k <= s; ++k)
    for (int a = 0; a < n; ++a) {
      const double* const own = x.data() + static_cast<std::size_t>(a) * s;
      double sum = legendre[k * (s + 1) + s] * own[s - 1];
      for (int j = 0; j + 1 < s; ++j) sum += legendre[k * (s + 1) + j] * own[j];
      coefficients_[k * n + a] = sum;
    }
}

void PolynomialContinuation::predict(std::span<const double> last, double ratio, std::span<double> x) {
  const int n = tables_.coordinates(), s = tables_.degree();
  coefficients(last);
  const auto terms = [&](double at) {  // P_k
    legendre_[0] = 1;
    legendre_[1] = at;
    for (int k = 1; k < s; ++k)
      legendre_[k + 1] = ((2 * k + 1) * at * legendre_[k] - k * legendre_[k - 1]) / (k + 1);
  };
  terms(1 + 2 * ratio);
  int order = 1;
  for (double before = INFINITY; order <= s; ++order) {
    double size = 0;
    for (int a = 0; a < n; ++a)
      size = std::max(size, std::abs(coefficients_[order * n + a] * legendre_[order]));
    if (order > 2 && size > before) break;
    before = size;
  }
  const std::vector<double>& lobatto = tables_.scheme().lobatto;
  std::fill(values_.begin(), values_.end(), 0.0);
  for (int j = 1; j <= s; ++j) {
    terms(1 + 2 * ratio * lobatto[j]);
    for (int k = 1; k < order; ++k)
      for (int a = 0; a < n; ++a) values_[j * n + a] += coefficients_[k * n + a] * (legendre_[k] - 1);
  }
  for (int a = 0; a < n; ++a) {
    const double delta = values_[s * n + a];
    x[a * s + s - 1] = delta;
    for (int j = 1; j < s; ++j) x[a * s + j - 1] = values_[j * n + a] - lobatto[j] * delta;
  }
}

PolynomialContinuation::Tail PolynomialContinuation::tail(std::span<const double> x, double magnitude) {
  constexpr double fastest = 1e-3;
  const int n = tables_.coordinates(), s = tables_.degree();
  coefficients(x);
  const auto size = [&](int k) {
    double largest = 0;
    for (int a = 0; a < n && k >= 1; ++a) largest = std::max(largest, std::abs(coefficients_[k * n + a]));
    return largest;
  };
  Tail tail;
  for (int k = 1; k <= s; ++k) tail.extent = std::max(tail.extent, size(k));
  const double last = size(s), second = size(s - 1), before = std::max(size(s - 2), size(s - 3));
  const double noise = 8 * unit_roundoff * tail.extent + 2 * unit_roundoff * magnitude;
  const double largest = std::max(last, second);
  if (largest < noise) {
    tail.fall = fastest;
    return tail;
  }
  tail.fall = std::clamp(std::sqrt(largest / std::max(before, largest)), fastest, 0.99);
  tail.size = std::max(last, second * tail.fall);
  return tail;
}

TrajectoryReader::TrajectoryReader(const Trajectory& trajectory, const StepTables& tables)
    : trajectory_(trajectory),
      tables_(tables),
      start_(tables.coordinates()),
      q_(tables.coordinates()),
      v_(tables.coordinates()) {}

void TrajectoryReader::at(double time, std::span<double> q) {
  const std::vector<double>& times = trajectory_.times;
  const int last = trajectory_.elements() - 1;
  while (element_ < last && times[element_ + 1] < time) ++element_;
  while (element_ > 0 && times[element_] > time) --element_;
  const double tau = std::min((time - times[element_]) / trajectory_.length(element_), 1.0);
  nodal_values(trajectory_.degree, tau, value_);
  element_point(trajectory_, element_, {value_, nullptr}, q.data(), v_.data(), 1);
}

void TrajectoryReader::predict(double time, double h, std::span<double> x) {
  const int n = tables_.coordinates(), s = tables_.degree();
  const std::vector<double>& lobatto = tables_.scheme().lobatto;
  at(time, start_);
  at(time + h, q_);
  for (int a = 0; a < n; ++a) x[a * s + s - 1] = q_[a] - start_[a];
  for (int j = 1; j < s; ++j) {
    at(time + lobatto[j] * h, q_);
    for (int a = 0; a < n; ++a) x[a * s + j - 1] = (q_[a] - start_[a]) - lobatto[j] * x[a * s + s - 1];
  }
}

}  // namespace extremal
