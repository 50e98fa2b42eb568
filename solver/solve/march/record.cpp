#include "solve/march/record.hpp"

#include "solve/march/limits.hpp"

namespace extremal {

MarchRecord::MarchRecord(const StepTables& tables, const InitialData& start, std::size_t expected,
                         bool recovering)
    : n_(tables.coordinates()),
      paired_(start.paired),
      output_(tables, recovering),
      low_(3 * start.q.size(), INFINITY),
      high_(3 * start.q.size(), -INFINITY) {
  for (const double q : start.q) state_.q.push_back({q, 0});
  for (const double p : start.p) {
    state_.p.push_back({p, 0});
    momentum_ = std::max(momentum_, std::abs(p));
  }
  before_ = state_;
  Trajectory& t = march_.trajectory;
  t.coordinates = n_;
  t.degree = output_.degree();
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
  Trajectory& t = march_.trajectory;
  const int count = t.degree + 1;
  const std::size_t first = t.nodes.size(), size = static_cast<std::size_t>(count) * n_;
  t.nodes.resize(first + size);
  t.slopes.resize(first + size);
  t.lengths.push_back(h);
  t.times.push_back(time);
  action_.add(solver.action());
  residual_ = std::max(residual_, solver.residual());
  before_ = state_;
  solver.advance(state_, time);
  if (paired_) agree();
  double *const q = t.nodes.data() + first, *const v = t.slopes.data() + first;
  output_.read(before_, x, state_, h, q, v);
  for (int a = 0; a < n_; ++a) {
    for (int j = 0; j < count; ++j) {
      low_[a] = std::min(low_[a], q[j * n_ + a]);
      high_[a] = std::max(high_[a], q[j * n_ + a]);
      low_[n_ + a] = std::min(low_[n_ + a], v[j * n_ + a]);
      high_[n_ + a] = std::max(high_[n_ + a], v[j * n_ + a]);
    }
    range_q_ = std::max(range_q_, high_[a] - low_[a]);
    range_v_ = std::max(range_v_, high_[n_ + a] - low_[n_ + a]);
    const double p = state_.p[a].high;
    momentum_ = std::max(momentum_, std::abs(p));
    low_[2 * n_ + a] = std::min({low_[2 * n_ + a], before_.p[a].high, p});
    high_[2 * n_ + a] = std::max({high_[2 * n_ + a], before_.p[a].high, p});
    range_p_ = std::max(range_p_, high_[2 * n_ + a] - low_[2 * n_ + a]);
  }
}

/// The second copy becomes the first: their difference follows the adjoint equations, which amplify roundoff
/// where forces damp the motion.
void MarchRecord::agree() {
  for (int a = 0, n = n_ / 2; a < n; ++a) {
    state_.q[n + a] = state_.q[a];
    state_.p[n + a] = {-state_.p[a].high, -state_.p[a].low};
  }
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
