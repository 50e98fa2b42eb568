#include "solve/search/balance.hpp"

#include <algorithm>
#include <cmath>

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

  std::vector<double> times, values;
  double fastest = 0;

 private:
  const Trajectory path_;
  std::vector<double> q_, v_;
};

Balance::Balance(const Problem& problem, const Path& path) {
  if (problem.ends.free > 0 || !problem.lagrangian->structure().autonomous) return;
  Speeds speeds(path);
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
  const bool begins = speeds.values[before] < tail, ends = speeds.values[after] < tail;
  if (begins && ends) return std::nullopt;
  Rest rest{{0, speeds.times[last]}, {0, speeds.times[last]}, 0, 0, true};
  std::vector<double> in, out;
  if (!begins) {
    rest.span.from = speeds.crossing(before + 1, before, tail);
    in = speeds.v();
  }
  if (!ends) {
    rest.span.to = speeds.crossing(after - 1, after, tail);
    out = speeds.v();
  }
  if (begins) in = out;
  if (ends) out = in;
  speeds.at(speeds.times[begins ? 0 : ends ? last : slowest]);
  const std::vector<double> none(in.size(), 0);
  Scratch scratch;
  const PointValues values = evaluate_at(lagrangian, speeds.q(), none, 0, Order::hessian, scratch);
  const auto rate = [&](const std::vector<double>& v) {
    return std::sqrt(form(v, values.qq, v) / form(v, values.vv, v));
  };
  const double kinetic = form(in, values.vv, in) * form(out, values.vv, out),
               r = 0.5 * (rate(in) + rate(out));
  if (!(r > 0) || !(kinetic > 0)) return std::nullopt;
  // An end beside the equilibrium has a part A of its own.
  double force = 0;
  for (std::size_t a = 0; a < in.size(); ++a) force += values.dq[a] * in[a];
  const double acceleration = std::abs(force) / form(in, values.vv, in) * length(in);
  const bool at_end = begins || ends;
  if (at_end && acceleration > off_equilibrium * r * std::max(least, speed_roundoff * speeds.fastest))
    return std::nullopt;
  rest.stiffness = at_end ? 2 * r : r;
  rest.log_energy = 0.5 * std::log(kinetic) - rest.stiffness * rest.span.length();
  rest.positive = form(in, values.vv, out) > 0;
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
    exists_ = exists_ && rest.span.length() + longer > 0;
  }
  shifts_.back() = 0;
}

std::vector<Balance::Span> Balance::spans() const {
  std::vector<Span> spans;
  for (const Rest& rest : rests_) spans.push_back(rest.span);
  return spans;
}

bool Balance::apply(Path& path) const { return exists_ && stretch(spans(), shifts_, shortest_element, path); }

bool Balance::falls() const {
  return rests_.size() > 1 && !std::ranges::all_of(rests_, [](const Rest& rest) { return rest.positive; });
}

bool Balance::fall(Path& path) const {
  std::vector<Span> spans = this->spans();
  std::size_t gone = rests_.size();
  double others = 0;
  for (std::size_t j = 0; j < rests_.size(); ++j) {
    others += spans[j].length();
    if (rests_[j].positive || (gone < j && rests_[gone].log_energy > rests_[j].log_energy)) continue;
    gone = j;
  }
  if (gone == rests_.size()) return false;
  others -= spans[gone].length();
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
