#include "solve/march/dense_output.hpp"

#include <algorithm>
#include <utility>

#include "action/rule.hpp"
#include "solve/march/limits.hpp"

namespace extremal {

namespace {

/// P_0 … P_order at 2τ − 1.
std::vector<double> legendre_values(int order, double tau) {
  const double x = 2 * tau - 1;
  std::vector<double> p{1, x};
  for (int k = 1; k < order; ++k) p.push_back(((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1));
  return p;
}

}  // namespace

DenseOutput::DenseOutput(const StepTables& tables, bool recovering)
    : tables_(tables),
      degree_(tables.degree()),
      first_(tables.coordinates()),
      last_(first_.size()),
      position_(first_.size()),
      momentum_(first_.size()) {
  const int s = tables.degree();
  if (recovering && s + 2 <= max_degree && Flow::suits(tables.lagrangian())) {
    flow_.emplace(tables.lagrangian());
    degree_ = s + 2;
  }
  node_ = lobatto_barycentric(degree_).nodes;
  const Basis basis = lobatto_basis(s, node_);
  for (int i = 0; i <= degree_; ++i) {
    for (int j = 1; j < s; ++j) {
      value_.push_back(basis.value[i * (s + 1) + j]);
      slope_.push_back(basis.derivative[i * (s + 1) + j]);
    }
    const std::vector<double> p = legendre_values(s + 2, node_[i]);
    const bool end = i == 0 || i == degree_;
    for (const int k : {0, 1}) {
      term_[k].push_back(p[s + k]);
      integral_[k].push_back(end ? 0 : (p[s + k + 1] - p[s + k - 1]) / (2 * (2 * (s + k) + 1)));
    }
  }
}

int DenseOutput::gain() const {
  const Structure& structure = tables_.lagrangian().structure();
  if (!flow_) return 0;
  return structure.quadratic && structure.velocity_free && structure.gyroscopic.empty() ? 2 : 1;
}

void DenseOutput::read(const MotionState& state, std::span<const double> x, const MotionState& end, double h,
                       double* q, double* v) {
  const int n = tables_.coordinates(), s = tables_.degree(), inner = s - 1;
  const double rate = 1 / h;
  bool recovers = flow_.has_value();
  // Where L jumps with time, an element that ends there has the velocities of just before.
  const double within = tables_.lagrangian().kinks()
                            ? std::max(limits::march::instant * h, limits::march::instant_digits * end.time)
                            : 0;
  const auto velocity = [&](const MotionState& at, double time, std::vector<double>& found) {
    for (int a = 0; a < n; ++a) {
      position_[a] = at.q[a].high;
      momentum_[a] = at.p[a].high;
    }
    return flow_->velocity(position_, momentum_, time, found);
  };
  const bool known = known_ && within == 0;
  if (recovers)
    recovers =
        (known || velocity(state, state.time + within, first_)) && velocity(end, end.time - within, last_);
  for (int a = 0; a < n; ++a) {
    const double* const own = x.data() + static_cast<std::size_t>(a) * s;
    const double start = state.q[a].high, rest = state.q[a].low, delta = own[s - 1];
    double even = 0, odd = 0;  // γ and δ
    const auto slope_at = [&](int i) {
      double slope = delta;
      for (int k = 0; k < inner; ++k) slope += slope_[i * inner + k] * own[k];
      return slope * rate;
    };
    if (recovers) {
      const double before = (s % 2 == 0 ? 1 : -1) * (first_[a] - slope_at(0)),
                   after = last_[a] - slope_at(degree_);
      even = 0.5 * (after + before);
      odd = 0.5 * (after - before);
    }
    for (int i = 0; i <= degree_; ++i) {
      double change = node_[i] * delta;
      for (int k = 0; k < inner; ++k) change += value_[i * inner + k] * own[k];
      q[i * n + a] = start + (rest + (change + h * (even * integral_[0][i] + odd * integral_[1][i])));
      v[i * n + a] = slope_at(i) + (even * term_[0][i] + odd * term_[1][i]);
    }
  }
  known_ = recovers;
  if (recovers) std::swap(first_, last_);
}

}  // namespace extremal
