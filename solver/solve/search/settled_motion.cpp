#include "solve/search/settled_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/dense.hpp"
#include "machine/bisect.hpp"
#include "motion/sample.hpp"
#include "problem/closing.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::settled_motion;
using Eigen::Index;

bool SettledMotion::suits(const Problem& problem) {
  return problem.periodic && problem.paired && !problem.extension &&
         problem.lagrangian->structure().autonomous == problem.duration.free && !problem.duration.where &&
         Flow::suits(*problem.lagrangian, 2);
}

SettledMotion::SettledMotion(const Problem& problem, std::function<bool()> more)
    : problem_(problem),
      more_(std::move(more)),
      n_(problem.coordinates() / 2),
      flow_(*problem.lagrangian, 2),
      method_([this](double t, auto y, auto slope) { return flow_.slope(t, y, slope); },
              static_cast<int>(2 * n_)) {
  // Both copies close alike.
  const ClosingMap map = closing_map(problem);
  back_ = inverse(map.r.topLeftCorner(n_, n_));
  transposed_ = map.r.topLeftCorner(n_, n_).transpose();
  shift_ = map.c.head(n_);
}

/// The state of the guess at t = 0.
bool SettledMotion::begin() {
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> q(2 * n), after(2 * n), v(n);
  problem_.guess.at(0, q);
  problem_.guess.at(step_of_guess, after);
  for (std::size_t a = 0; a < n; ++a) v[a] = (after[a] - q[a]) / (step_of_guess * problem_.duration.value);
  start_.resize(2 * n_);
  std::copy_n(q.begin(), n, start_.begin());
  const std::span<double> y(start_.data(), 2 * n);
  return flow_.momentum(y.first(n), v, 0, y.subspan(n));
}

/// To `end`, as long as on_step(t before the step) allows.
bool SettledMotion::follow(State& y, double& t, double end, const std::function<bool(double)>& on_step) {
  IntegrationOptions options{.tolerance = settling_error, .block = static_cast<int>(n_), .least = {}};
  const std::span<double> state(y.data(), static_cast<std::size_t>(y.size()));
  while (t < end) {
    const double before = t;
    // Where a force jumps as a momentum passes zero, no step has an error that is small beside this momentum.
    options.least = {size_[0], size_[1]};
    if (!more_() || method_.accept_step(t, state, end, options) != Integrated::done) return false;
    size_[0] = std::max(size_[0], y.head(n_).lpNorm<Eigen::Infinity>());
    size_[1] = std::max(size_[1], y.tail(n_).lpNorm<Eigen::Infinity>());
    if (on_step && !on_step(before)) return true;
  }
  return true;
}

/// Where a state stands in the orbit that begins one return later: of q(T) = R q(0) + c, R⁻¹ (q − c) and Rᵀ
/// p.
SettledMotion::State SettledMotion::returned(const State& y) const {
  State result(y.size());
  result << back_ * (y.head(n_) - shift_), transposed_ * y.tail(n_);
  return result;
}

double SettledMotion::distance(const State& a, const State& b) const {
  double found = 0;
  for (const int part : {0, 1})
    if (size_[part] > 0)
      found = std::max(found, (a - b).segment(part * n_, n_).lpNorm<Eigen::Infinity>() / size_[part]);
  return found;
}

/// After the duration that is given; where it is free, when the motion passes the plane across the motion at
/// y. If it does not, y is where it has come.
bool SettledMotion::next_return(State& y, double& duration) {
  const double expected = problem_.duration.value;
  double t = 0;
  if (!problem_.duration.free) {
    duration = expected;
    if (!follow(y, t, expected)) return false;
    y = returned(y);
    return true;
  }
  const State from = y;
  State normal(y.size()), between(y.size());
  const auto size = static_cast<std::size_t>(y.size());
  if (!flow_.slope(0, {from.data(), size}, {normal.data(), size})) return false;
  for (const int part : {0, 1})
    if (size_[part] > 0) normal.segment(part * n_, n_) /= size_[part] * size_[part];
  const auto side = [&](const State& at) { return normal.dot(returned(at) - from); };
  const auto interpolated = [&](double theta) {
    method_.interpolate(theta, {between.data(), size});
    return side(between);
  };
  double before_side = 0;
  bool found = false;
  const auto on_step = [&](double before) {
    const double now = side(y);
    const bool passes = before > earliest_return * expected && before_side < 0 && now >= 0;
    before_side = now;
    if (!passes || !method_.prepare_interpolation({y.data(), size}, static_cast<int>(size))) return true;
    const auto before_return = [&](double theta) { return interpolated(theta) < 0; };
    const double returned_at = bisect(0, 1, bisections, before_return).high;
    interpolated(returned_at);
    duration = before + returned_at * (t - before);
    found = true;
    return false;
  };
  if (!follow(y, t, latest_return * expected, on_step)) return false;
  y = returned(found ? between : y);
  if (!found) duration = 0;
  return true;
}

bool SettledMotion::run() {
  if (!problem_.guess.given() || !begin()) return false;
  State y = start_;
  double t = 0;
  if (!follow(y, t, problem_.duration.value)) return false;
  for (int k = 0; k < most_returns; ++k) {
    const State before = y;
    if (!next_return(y, duration_)) return false;
    if (duration_ > 0 && distance(y, before) <= closed_nearly) return sample(before, duration_);
  }
  return false;
}

/// False where nothing moves any more.
bool SettledMotion::sample(const State& start, double duration) {
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> q(start.begin(), start.begin() + n_), v(n);
  const std::span<const double> y(start.data(), 2 * n);
  if (!flow_.velocity(y.first(n), y.subspan(n), 0, v)) return false;
  SampledMotion samples;
  if (!sample_motion<double>(
          flow_, q, v, 0, duration,
          {settling_error, settling_samples, duration, [this](int) { return more_(); }, {size_[0], size_[1]}},
          samples))
    return false;
  double range = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t k = a; k < samples.q.size(); k += n) {
      low = std::min(low, samples.q[k]);
      high = std::max(high, samples.q[k]);
    }
    range = std::max(range, high - low);
  }
  if (!(range > least_range * size_[0])) return false;
  orbit_.tau = std::move(samples.tau);
  orbit_.samples_a_step = settling_samples;
  for (std::size_t k = 0; k < samples.q.size(); k += n)
    for (int copy = 0; copy < 2; ++copy)
      orbit_.q.insert(orbit_.q.end(), samples.q.begin() + k, samples.q.begin() + k + n);
  return true;
}

}  // namespace extremal
