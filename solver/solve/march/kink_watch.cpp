#include "solve/march/kink_watch.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "solve/march/limits.hpp"

namespace extremal {

using namespace limits::march;

KinkWatch::KinkWatch(const StepTables& tables, const MotionState& start)
    : tables_(tables),
      kinks_(tables.lagrangian().kinks()),
      value_(max_degree + 1),
      derivative_(max_degree + 1),
      q_(tables.coordinates()),
      v_(tables.coordinates()) {
  if (!kinks_) return;
  sides_.resize(kinks_->surfaces().size());
  // Velocities are known from the first element on; a surface through the start is left by it.
  const std::vector<double> rest(tables.unknowns(), 0.0);
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    sides_[s].value = at(kinks_->surfaces()[s], start, rest, 1, 0);
    sides_[s].on = sides_[s].value == 0;
  }
}

double KinkWatch::at(const KinkSurface& surface, const MotionState& state, std::span<const double> x,
                     double h, double tau) {
  const int n = tables_.coordinates(), s = tables_.degree();
  lobatto_basis_at(s, tau, value_.data(), derivative_.data());
  for (int a = 0; a < n; ++a) {
    const double* const own = x.data() + static_cast<std::size_t>(a) * s;
    double change = tau * own[s - 1], slope = own[s - 1];
    for (int j = 1; j < s; ++j) {
      change += value_[j] * own[j - 1];
      slope += derivative_[j] * own[j - 1];
    }
    q_[a] = state.q[a].high + (state.q[a].low + change);
    v_[a] = slope / h;
  }
  return evaluate_at(*surface.u, q_, v_, state.time + tau * h, Order::value, scratch_).value;
}

double KinkWatch::expected(double h) const {
  double least = h;
  for (const Side& side : sides_) {
    if (side.on || side.rate == 0) continue;
    const double time = -side.value / side.rate;
    if (time > 0) least = std::min(least, time);
  }
  return least;
}

KinkWatch::Verdict KinkWatch::judge(const MotionState& state, std::span<const double> x, double h,
                                    double precision) {
  Verdict verdict;
  next_.assign(sides_.size(), {});
  const std::vector<double>& points = tables_.scheme().node;
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    const KinkSurface& surface = kinks_->surfaces()[s];
    double before = sides_[s].on ? 0 : sides_[s].value, tau_before = 0, crossed = 2;
    for (const double tau : points) {
      const double u = at(surface, state, x, h, tau);
      if (before * u < 0 && crossed > 1) crossed = tau_before + (tau - tau_before) * before / (before - u);
      before = u;
      tau_before = tau;
    }
    const double end = at(surface, state, x, h, 1), rate = (end - before) / ((1 - tau_before) * h);
    next_[s] = {end, rate, false};
    if (crossed <= 1) {
      verdict.length = std::min(verdict.length.value_or(INFINITY), std::max(crossed, kink_least) * h);
      continue;
    }
    if (rate == 0 || before * rate > 0) continue;  // it goes away
    const double missed = -end / rate;             // the time from the end to the surface
    next_[s].on = std::abs(missed) <= precision;
    // On the surface it is as long as another step brings it nearer.
    const bool nearer = std::abs(missed) < 0.5 * missed_;
    if (missed < kink_near * h && (!next_[s].on || (missed != 0 && nearer)))
      verdict.length = std::min(verdict.length.value_or(INFINITY), h + missed);
    if (next_[s].on) missed_ = std::abs(missed);
  }
  // An element that ends on one surface does not go on to another that is near.
  const bool ends_on_one = std::ranges::any_of(next_, &Side::on);
  if (ends_on_one && verdict.length && *verdict.length > h + precision) verdict.length.reset();
  return verdict;
}

bool KinkWatch::accept() {
  sides_ = next_;
  missed_ = INFINITY;
  return std::ranges::any_of(sides_, [](const Side& side) { return side.on; });
}

int kinked_elements(const Lagrangian& lagrangian, const Trajectory& trajectory) {
  const Kinks* kinks = lagrangian.kinks();
  if (!kinks) return 0;
  const std::size_t n = trajectory.coordinates, size = (trajectory.degree + 1) * n;
  const std::size_t surfaces = kinks->surfaces().size();
  std::vector<double> before(surfaces, 0.0);
  Scratch scratch;
  int count = 0;
  for (int k = 0; k < trajectory.elements(); ++k) {
    const std::size_t last = (k + 1) * size - n;
    const std::span<const double> q(trajectory.nodes.data() + last, n), v(trajectory.slopes.data() + last, n);
    bool crosses = false;
    for (std::size_t s = 0; s < surfaces; ++s) {
      const double u =
          evaluate_at(*kinks->surfaces()[s].u, q, v, trajectory.times[k + 1], Order::value, scratch).value;
      crosses = crosses || u * before[s] < 0;
      if (u != 0) before[s] = u;
    }
    count += crosses;
  }
  return count;
}

}  // namespace extremal
