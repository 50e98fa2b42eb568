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

Balance::Balance(const Problem& problem, const Path& path, Accuracy accuracy) {
  if (problem.ends.free > 0 || !problem.lagrangian->structure().autonomous) return;
  Speeds speeds(path);
  const auto fastest = std::ranges::max_element(speeds.values) - speeds.values.begin();
  Scratch scratch;
  speeds.at(speeds.times[fastest]);
  kinetic_ = form(speeds.v(),
                  evaluate_at(*problem.lagrangian, speeds.q(), speeds.v(), 0, Order::hessian, scratch).vv,
                  speeds.v());
  fastest_ = speeds.fastest;
  const double slow = resting * fastest_;
  const std::size_t count = speeds.times.size();
  bool all = true;
  for (std::size_t i = 0; i < count && all; ++i) {
    if (!(speeds.values[i] < slow)) continue;
    std::size_t slowest = i;
    for (; i < count && speeds.values[i] < slow; ++i)
      if (speeds.values[i] < speeds.values[slowest]) slowest = i;
    const std::optional<Rest> rest = measure(*problem.lagrangian, speeds, slowest, accuracy);
    all = rest.has_value();
    if (all) rests_.push_back(*rest);
    rest_speed_ = std::max(rest_speed_, speeds.values[slowest] / speeds.fastest);
  }
  if (all) balance();
}

/// Nothing if the path has no such tail at all, or none of an energy.
std::optional<Balance::Tails> Balance::tails(const NearEquilibrium& equilibrium, Speeds& speeds,
                                             std::size_t slowest, double speed) {
  const std::size_t last = speeds.times.size() - 1;
  std::size_t before = slowest, after = slowest;
  while (before > 0 && speeds.values[before] < speed) --before;
  while (after < last && speeds.values[after] < speed) ++after;
  // A tail ends where the path does.
  const bool begins = speeds.values[before] < speed, ends = speeds.values[after] < speed;
  if (begins && ends) return std::nullopt;
  Tails found;
  found.span.from = speeds.tail_end(slowest, before, speed);
  const std::vector<double> q = speeds.q(), v = speeds.v();
  found.span.to = speeds.tail_end(slowest, after, speed);
  found.energy =
      equilibrium.energy({q, v, begins}, {speeds.q(), speeds.v(), ends}, speed_roundoff * speeds.fastest);
  if (!std::isfinite(found.value().log)) return std::nullopt;
  return found;
}

/// The rest about the sample of least speed; nothing if its tails are not those of an equilibrium.
std::optional<Balance::Rest> Balance::measure(const Lagrangian& lagrangian, Speeds& speeds,
                                              std::size_t slowest, Accuracy accuracy) {
  speeds.at(speeds.times[slowest]);
  const NearEquilibrium equilibrium(lagrangian, speeds.q());
  if (!equilibrium.hyperbolic()) return std::nullopt;
  const double least = tail_growth * speeds.values[slowest],
               tail = std::max(tail_speed * speeds.fastest, least);
  const std::optional<Tails> found = tails(equilibrium, speeds, slowest, tail);
  if (!found) return std::nullopt;
  Rest rest{.tails = *found, .slow = {}, .cost = equilibrium.cost(), .doubt = tail / speeds.fastest};
  if (accuracy == Accuracy::extrapolated) extrapolate(equilibrium, speeds, slowest, 4 * tail, least, rest);
  std::size_t before = slowest, after = slowest;
  while (before > 0 && speeds.values[before] < moving * speeds.fastest) --before;
  while (after + 1 < speeds.times.size() && speeds.values[after] < moving * speeds.fastest) ++after;
  rest.slow = {speeds.times[before], speeds.times[after]};
  return rest;
}

/// What the equations of a tail of speed a are not linear in changes the logarithm of the energy by
/// c₁ a + c₂ a² + …; tails of a, 2a and 4a tell c₁ and c₂. The slower the tails, the less is left of that,
/// and the more of the errors of the path: the speed is taken at which c₂ changes the result least.
void Balance::extrapolate(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                          double fastest_tail, double least, Rest& rest) {
  const double measured = rest.tails.value().log;
  std::vector<double> logs;
  for (double speed = fastest_tail; speed >= least && logs.size() < most_tails; speed /= 2) {
    const std::optional<Tails> found = tails(equilibrium, speeds, slowest, speed);
    if (!found) return;
    logs.push_back(found->value().log);
    if (logs.size() < 3) continue;
    const double four = logs[logs.size() - 3], two = logs[logs.size() - 2], one = logs.back();
    const double linear = 2 * one - two, quadratic = (8 * one - 6 * two + four) / 3;
    if (!(std::abs(quadratic - linear) < rest.doubt)) continue;
    rest.doubt = std::abs(quadratic - linear);
    rest.correction = quadratic - measured;
  }
}

RestEnergy::Value Balance::Rest::at(double length) const {
  RestEnergy::Value value = tails.energy.at(length);
  value.log += correction;
  return value;
}

/// Lengths of rests, the sum of which is given, for which the logarithms of the energies agree; before the
/// first rest and after the last nothing is shifted.
void Balance::balance() {
  if (rests_.size() < 2) return;
  const bool positive = std::ranges::any_of(rests_, [](const Rest& rest) { return rest.value().positive; });
  std::vector<double> longer;
  for (const Rest& rest : rests_) {
    const std::optional<double> held = rest.tails.energy.held_near(rest.length(), positive);
    if (!held) return;
    longer.push_back(*held - rest.length());
  }
  double change = INFINITY;
  for (int step = 0; step < most_length_steps && change > balanced; ++step) {
    double sum = 0, weights = 0;
    std::vector<RestEnergy::Value> values;
    for (std::size_t j = 0; j < rests_.size(); ++j) {
      values.push_back(rests_[j].at(rests_[j].length() + longer[j]));
      sum += longer[j] + values[j].log / values[j].stiffness;
      weights += 1 / values[j].stiffness;
    }
    change = 0;
    for (std::size_t j = 0; j < rests_.size(); ++j) {
      double more = (values[j].log - sum / weights) / values[j].stiffness;
      if (!std::isfinite(more)) return;
      change = std::max(change, std::abs(more * values[j].stiffness));
      const double length = rests_[j].length() + longer[j];
      while (!rests_[j].tails.energy.held_at(length + more, positive)) more /= 2;
      longer[j] += more;
    }
  }
  if (!(change <= balanced)) return;
  exists_ = true;
  double shift = 0;
  for (std::size_t j = 0; j < rests_.size(); ++j) {
    const Rest& rest = rests_[j];
    shift += longer[j];
    shifts_.push_back(shift);
    const double stiffness = rest.at(rest.length() + longer[j]).stiffness;
    error_ = std::max(error_, fastest_ * rest.doubt / stiffness);
    largest_shift_ = std::max(largest_shift_, std::abs(longer[j]) * stiffness);
    // With tails that are faster than those measured there may still be a rest.
    const bool long_enough = rest.length() + longer[j] > still_long * rest.length();
    stretched_.push_back(long_enough ? rest.tails.span : rest.slow);
    exists_ = exists_ && stretched_.back().length() + longer[j] > 0;
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
  return excess > std::exp(rest.value().log) + cost_roundoff * (digits + kinetic_) ? excess : 0;
}

std::size_t Balance::falling() const {
  std::size_t gone = rests_.size();
  if (rests_.size() < 2) return gone;
  for (std::size_t j = 0; j < rests_.size(); ++j) {
    if (excess(rests_[j]) == 0 && rests_[j].tails.energy.held_near(rests_[j].length(), true)) continue;
    const bool worse =
        gone == rests_.size() || excess(rests_[j]) > excess(rests_[gone]) ||
        (excess(rests_[j]) == excess(rests_[gone]) && rests_[j].value().log > rests_[gone].value().log);
    if (worse) gone = j;
  }
  return gone;
}

bool Balance::falls() const { return falling() < rests_.size(); }

bool Balance::fall(Path& path) const {
  std::vector<Span> spans;
  for (const Rest& rest : rests_) spans.push_back(rest.tails.span);
  const std::size_t gone = falling();
  if (gone == rests_.size()) return false;
  double others = 0;
  for (std::size_t j = 0; j < rests_.size(); ++j) others += j == gone ? 0 : spans[j].length();
  spans[gone] = rests_[gone].slow;
  const double shorter =
      spans[gone].length() - std::min(spans[gone].length(), 1 / rests_[gone].value().stiffness);
  std::vector<double> shifts;
  double shift = 0;
  for (std::size_t j = 0; j < spans.size(); ++j)
    shifts.push_back(shift += j == gone ? -shorter : shorter * spans[j].length() / others);
  shifts.back() = 0;
  return stretch(spans, shifts, 0, path);
}

int count_rests(const Trajectory& path) {
  const std::size_t n = path.coordinates, stride = (path.degree + 1) * n;
  std::vector<double> speeds;
  for (int k = 0; k < path.elements(); ++k) {
    const double* first = path.nodes.data() + k * stride;
    const double* last = first + path.degree * n;
    double square = 0;
    for (std::size_t a = 0; a < n; ++a) square += (last[a] - first[a]) * (last[a] - first[a]);
    speeds.push_back(std::sqrt(square) / path.length(k));
  }
  const double slow = speeds.empty() ? 0 : resting * *std::ranges::max_element(speeds);
  int rests = 0;
  for (std::size_t k = 0; k < speeds.size(); ++k)
    rests += speeds[k] < slow && !(k > 0 && speeds[k - 1] < slow);
  return rests;
}

}  // namespace extremal
