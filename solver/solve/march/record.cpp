#include "solve/march/record.hpp"

#include "solve/march/limits.hpp"

namespace extremal {

MarchRecord::MarchRecord(const StepTables& tables, const InitialData& start, std::size_t expected)
    : tables_(tables), low_(2 * start.q.size(), INFINITY), high_(2 * start.q.size(), -INFINITY) {
  for (const double q : start.q) state_.q.push_back({q, 0});
  for (const double p : start.p) {
    state_.p.push_back({p, 0});
    momentum_ = std::max(momentum_, std::abs(p));
  }
  Trajectory& t = march_.trajectory;
  t.coordinates = tables.coordinates();
  t.degree = tables.degree();
  t.times = {0};
  t.times.reserve(expected + 1);
  t.lengths.reserve(expected);
  const std::size_t numbers = expected * (t.degree + 1) * start.q.size();
  t.nodes.reserve(numbers);
  t.slopes.reserve(numbers);
}

bool MarchRecord::full() const {
  return static_cast<double>(march_.trajectory.nodes.size()) > limits::march::most_numbers;
}

void MarchRecord::add(const ElementSolver& solver, std::span<const double> x, double h, double time) {
  const int n = tables_.coordinates(), s = tables_.degree();
  const double* const lobatto = tables_.scheme().lobatto.data();
  const double* const derivative = tables_.node_slope().data();
  Trajectory& t = march_.trajectory;
  const std::size_t first = t.nodes.size(), size = static_cast<std::size_t>(s + 1) * n;
  t.nodes.resize(first + size);
  t.slopes.resize(first + size);
  double *const q = t.nodes.data() + first, *const v = t.slopes.data() + first;
  const double rate = 1 / h;
  for (int a = 0; a < n; ++a) {
    const double* const own = x.data() + static_cast<std::size_t>(a) * s;
    const double start = state_.q[a].high, rest = state_.q[a].low, delta = own[s - 1];
    double low = low_[a], high = high_[a], slow = low_[n + a], fast = high_[n + a];
    for (int j = 0; j <= s; ++j) {
      double deviation = 0, slope = delta;
      if (j > 0 && j < s) deviation = own[j - 1];
      for (int k = 0; k + 1 < s; ++k) slope += derivative[j * (s - 1) + k] * own[k];
      const double value = start + (rest + (lobatto[j] * delta + deviation));
      const double speed = slope * rate;
      q[j * n + a] = value;
      v[j * n + a] = speed;
      low = std::min(low, value);
      high = std::max(high, value);
      slow = std::min(slow, speed);
      fast = std::max(fast, speed);
    }
    low_[a] = low;
    high_[a] = high;
    low_[n + a] = slow;
    high_[n + a] = fast;
    range_q_ = std::max(range_q_, high - low);
    range_v_ = std::max(range_v_, fast - slow);
  }
  t.lengths.push_back(h);
  t.times.push_back(time);
  action_.add(solver.action());
  residual_ = std::max(residual_, solver.residual());
  solver.advance(state_, time);
  for (const LongSum& p : state_.p) momentum_ = std::max(momentum_, std::abs(p.high));
}

March MarchRecord::finish(March::End end) {
  march_.end = end;
  march_.last = state_;
  march_.reached = state_.time;
  march_.action = action_.high;
  march_.finer_action = finer_action_.high;
  march_.residual = momentum_ > 0 ? residual_ / momentum_ : 0;
  return std::move(march_);
}

}  // namespace extremal
