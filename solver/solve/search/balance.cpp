#include "solve/search/balance.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "solution/solution.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::balance;

namespace {

double form(std::span<const double> x, std::span<const double> matrix, std::span<const double> y) {
  double sum = 0;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (std::size_t b = 0; b < y.size(); ++b) sum += x[a] * matrix[a * x.size() + b] * y[b];
  return sum;
}

double length(std::span<const double> x) {
  double sum = 0;
  for (double a : x) sum += a * a;
  return std::sqrt(sum);
}

/// Moves what is after each span by its shift. False, and nothing is done, where an element would become
/// shorter than `shortest` of itself.
template <class Spans>
bool stretch(const Spans& spans, std::span<const double> shifts, double shortest, Path& path) {
  const double T = path.duration();
  std::vector<double> times(path.mesh().begin(), path.mesh().end());
  for (double& tau : times) {
    const double t = tau * T;
    double shift = 0;
    for (std::size_t j = 0; j < spans.size() && t > spans[j].from; ++j) {
      const double part = std::min(1.0, (t - spans[j].from) / spans[j].length());
      const double before = j > 0 ? shifts[j - 1] : 0;
      shift = before + part * (shifts[j] - before);
    }
    tau = shift / T;
  }
  if (!path.move_mesh(times, 1, shortest)) return false;
  path.load_ends();
  return true;
}

}  // namespace

/// Speeds along a trajectory, at times that its elements give.
class Balance::Speeds {
 public:
  explicit Speeds(const Path& path) : path_(trajectory_of(path)), q_(path.coordinates()), v_(q_) {
    for (int k = 0; k < path_.elements(); ++k)
      for (int j = 0; j < speed_samples; ++j)
        times.push_back(path_.times[k] + (path_.times[k + 1] - path_.times[k]) * j / speed_samples);
    times.push_back(path_.duration());
    for (double t : times) {
      values.push_back(at(t));
      fastest = std::max(fastest, values.back());
    }
  }

  double at(double t) {
    path_.at(t, q_, v_);
    return length(v_);
  }
  /// q and q' where at() was called last.
  const std::vector<double>& q() const { return q_; }
  const std::vector<double>& v() const { return v_; }

  /// Between the sample i, where the speed is less than `speed`, and a neighbour, where it is not.
  double crossing(std::size_t i, std::size_t neighbour, double speed) {
    double slower = times[i], faster = times[neighbour];
    for (int step = 0; step < halvings; ++step) {
      const double middle = 0.5 * (slower + faster);
      (at(middle) < speed ? slower : faster) = middle;
    }
    at(slower);
    return slower;
  }

  /// The time on the way from sample `slowest` to `faster`, by samples between, at which the speed is
  /// `tail`; or that of `faster` if the path ends slower than that. at() is left there.
  double tail_end(std::size_t slowest, std::size_t faster, double tail) {
    if (!(values[faster] < tail)) return crossing(faster < slowest ? faster + 1 : faster - 1, faster, tail);
    at(times[faster]);
    return times[faster];
  }

  std::vector<double> times, values;
  double fastest = 0;

 private:
  const Trajectory path_;
  std::vector<double> q_, v_;
};

/// The equilibrium beside the slowest sample of a rest, where L is stationary in q without velocity.
class Balance::Equilibrium {
 public:
  Equilibrium(const Lagrangian& lagrangian, Speeds& speeds, std::size_t slowest)
      : lagrangian_(lagrangian), none_(speeds.v().size(), 0) {
    speeds.at(speeds.times[slowest]);
    std::vector<double> q = speeds.q();
    const auto n = static_cast<Eigen::Index>(q.size());
    for (int step = 0;; ++step) {
      values_ = evaluate_at(lagrangian, q, none_, 0, Order::hessian, scratch_);
      if (step == newton_steps) return;
      const Eigen::Map<const Eigen::VectorXd> force(values_.dq.data(), n);
      const Eigen::Map<const Eigen::MatrixXd> stiffness(values_.qq.data(), n, n);
      Eigen::Map<Eigen::VectorXd>(q.data(), n) -= Eigen::VectorXd(solved(stiffness, force));
    }
  }

  double mass(const std::vector<double>& a, const std::vector<double>& b) const {
    return form(a, values_.vv, b);
  }
  double rate(const std::vector<double>& v) const { return std::sqrt(form(v, values_.qq, v) / mass(v, v)); }
  /// L there.
  double cost() const { return values_.value; }
  /// Whether the path is there at this sample: elsewhere it is accelerated, against the speed that it has.
  bool holds(Speeds& speeds, std::size_t sample) {
    const double speed = speeds.at(speeds.times[sample]);
    const PointValues at = evaluate_at(lagrangian_, speeds.q(), none_, 0, Order::gradient, scratch_);
    const std::vector<double>& v = speeds.v();
    double force = 0;
    for (std::size_t a = 0; a < v.size(); ++a) force += at.dq[a] * v[a];
    const double acceleration = std::abs(force) / mass(v, v) * length(v);
    return !(acceleration > off_equilibrium * rate(v) * std::max(speed, speed_roundoff * speeds.fastest));
  }

 private:
  const Lagrangian& lagrangian_;
  const std::vector<double> none_;
  PointValues values_;
  Scratch scratch_;
};

Balance::Balance(const Problem& problem, const Path& path) {
  if (problem.ends.free > 0 || !problem.lagrangian->structure().autonomous) return;
  Speeds speeds(path);
  const auto fastest = std::ranges::max_element(speeds.values) - speeds.values.begin();
  Scratch scratch;
  speeds.at(speeds.times[fastest]);
  kinetic_ = form(speeds.v(),
                  evaluate_at(*problem.lagrangian, speeds.q(), speeds.v(), 0, Order::hessian, scratch).vv,
                  speeds.v());
  const double slow = resting * speeds.fastest;
  const std::size_t count = speeds.times.size();
  bool all = true;
  for (std::size_t i = 0; i < count && all; ++i) {
    if (!(speeds.values[i] < slow)) continue;
    std::size_t slowest = i;
    for (; i < count && speeds.values[i] < slow; ++i)
      if (speeds.values[i] < speeds.values[slowest]) slowest = i;
    const std::optional<Rest> rest = measure(*problem.lagrangian, speeds, slowest);
    all = rest.has_value();
    if (all) rests_.push_back(*rest);
    rest_speed_ = std::max(rest_speed_, speeds.values[slowest] / speeds.fastest);
  }
  if (all) balance();
}

/// The rest about the sample of least speed; nothing if its tails are not those of an equilibrium.
std::optional<Balance::Rest> Balance::measure(const Lagrangian& lagrangian, Speeds& speeds,
                                              std::size_t slowest) {
  const std::size_t last = speeds.times.size() - 1;
  const double least = speeds.values[slowest],
               tail = std::max(tail_speed * speeds.fastest, tail_growth * least);
  std::size_t before = slowest, after = slowest;
  while (before > 0 && speeds.values[before] < tail) --before;
  while (after < last && speeds.values[after] < tail) ++after;
  Equilibrium equilibrium(lagrangian, speeds, slowest);
  // A tail ends where the path does; an end beside the equilibrium has none.
  const bool begins = speeds.values[before] < tail && equilibrium.holds(speeds, 0);
  const bool ends = speeds.values[after] < tail && equilibrium.holds(speeds, last);
  if (begins && ends) return std::nullopt;
  Rest rest{{0, speeds.times[last]}, {0, speeds.times[last]}, 0, 0, true, equilibrium.cost()};
  std::vector<double> in, out;
  if (!begins) {
    rest.span.from = speeds.tail_end(slowest, before, tail);
    in = speeds.v();
  }
  if (!ends) {
    rest.span.to = speeds.tail_end(slowest, after, tail);
    out = speeds.v();
  }
  if (begins) in = out;
  if (ends) out = in;
  const double kinetic = equilibrium.mass(in, in) * equilibrium.mass(out, out),
               r = 0.5 * (equilibrium.rate(in) + equilibrium.rate(out));
  if (!(r > 0) || !(kinetic > 0)) return std::nullopt;
  rest.stiffness = begins || ends ? 2 * r : r;
  rest.log_energy = 0.5 * std::log(kinetic) - rest.stiffness * rest.span.length();
  rest.positive = equilibrium.mass(in, out) > 0;
  while (before > 0 && speeds.values[before] < moving * speeds.fastest) --before;
  while (after < last && speeds.values[after] < moving * speeds.fastest) ++after;
  rest.slow = {speeds.times[before], speeds.times[after]};
  return rest;
}

/// The energies are e^C for log_energy − stiffness·(shift after − shift before) = C; before the first rest
/// and after the last nothing is shifted.
void Balance::balance() {
  if (rests_.size() < 2) return;
  double sum = 0, weights = 0, shift = 0;
  for (const Rest& rest : rests_) {
    if (rest.positive != rests_.front().positive) return;
    sum += rest.log_energy / rest.stiffness;
    weights += 1 / rest.stiffness;
  }
  exists_ = true;
  for (const Rest& rest : rests_) {
    const double longer = (rest.log_energy - sum / weights) / rest.stiffness;
    shift += longer;
    shifts_.push_back(shift);
    largest_shift_ = std::max(largest_shift_, std::abs(longer) * rest.stiffness);
    // With tails that are faster than those measured there may still be a rest.
    const bool long_enough = rest.span.length() + longer > still_long * rest.span.length();
    stretched_.push_back(long_enough ? rest.span : rest.slow);
    exists_ = exists_ && stretched_.back().length() + longer > 0;
  }
  shifts_.back() = 0;
}

bool Balance::apply(Path& path) const {
  return exists_ && stretch(stretched_, shifts_, shortest_element, path);
}

/// By how much the energy of a rest is less than the largest, as far as L at its equilibrium tells.
double Balance::excess(const Rest& rest) const {
  double least = INFINITY, digits = 0;
  for (const Rest& other : rests_) {
    least = std::min(least, other.cost);
    digits = std::max(digits, std::abs(other.cost));
  }
  const double excess = rest.cost - least;
  return excess > 2 * std::exp(rest.log_energy) + cost_roundoff * (digits + kinetic_) ? excess : 0;
}

std::size_t Balance::falling() const {
  std::size_t gone = rests_.size();
  if (rests_.size() < 2) return gone;
  for (std::size_t j = 0; j < rests_.size(); ++j) {
    if (rests_[j].positive && excess(rests_[j]) == 0) continue;
    const bool worse =
        gone == rests_.size() || excess(rests_[j]) > excess(rests_[gone]) ||
        (excess(rests_[j]) == excess(rests_[gone]) && rests_[j].log_energy > rests_[gone].log_energy);
    if (worse) gone = j;
  }
  return gone;
}

bool Balance::falls() const { return falling() < rests_.size(); }

bool Balance::fall(Path& path) const {
  std::vector<Span> spans;
  for (const Rest& rest : rests_) spans.push_back(rest.span);
  const std::size_t gone = falling();
  if (gone == rests_.size()) return false;
  double others = 0;
  for (std::size_t j = 0; j < rests_.size(); ++j) others += j == gone ? 0 : spans[j].length();
  spans[gone] = rests_[gone].slow;
  const double shorter = spans[gone].length() - std::min(spans[gone].length(), 1 / rests_[gone].stiffness);
  std::vector<double> shifts;
  double shift = 0;
  for (std::size_t j = 0; j < spans.size(); ++j)
    shifts.push_back(shift += j == gone ? -shorter : shorter * spans[j].length() / others);
  shifts.back() = 0;
  return stretch(spans, shifts, 0, path);
}

}  // namespace extremal
