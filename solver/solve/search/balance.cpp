#include "solve/search/balance.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "machine/bisect.hpp"
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
    const auto slow = [&](double t) { return at(t) < speed; };
    const double slower = bisect(times[i], times[neighbour], halvings, slow).low;
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
  }
  if (all) balance();
}

/// Nothing if the path has no such tail at all.
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
  found.energy = equilibrium.energy({q, v, begins}, {speeds.q(), speeds.v(), ends},
                                    speed_roundoff * speeds.fastest, speed / speeds.fastest);
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
  Rest rest{.tails = *found, .slow = {}, .cost = equilibrium.cost()};
  if (accuracy == Accuracy::extrapolated)
    rest.tails.energy = extrapolate(equilibrium, speeds, slowest,
                                    std::min(fastest_tail * tail, moving * speeds.fastest), least, *found);
  rest.tails.energy = rest.tails.energy.known();
  if (!std::isfinite(rest.value().log)) return std::nullopt;
  std::size_t before = slowest, after = slowest;
  while (before > 0 && speeds.values[before] < moving * speeds.fastest) --before;
  while (after + 1 < speeds.times.size() && speeds.values[after] < moving * speeds.fastest) ++after;
  rest.slow = {speeds.times[before], speeds.times[after]};
  return rest;
}

/// A tail of speed a has weights w + c₁ a + c₂ a² + …, since its equations are not linear; tails of a, 2a,
/// 4a, … determine the cᵢ. The result with the least doubt is taken: slow tails have more of the errors of
/// the path. Where motions turn about the equilibrium the cᵢ may depend on the phase. A result may then have
/// little doubt by chance, and must agree with the one before.
RestEnergy Balance::extrapolate(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                                double fastest, double least, const Tails& measured) {
  const double length = measured.span.length(), exponent = -measured.energy.log_size(length);
  RestEnergy best = measured.energy;
  std::optional<RestEnergy> before;
  std::vector<Tails> all;
  all.reserve(most_tails);
  std::vector<RestEnergy::OfTail> tails_of_all;
  for (double speed = fastest; speed >= least && all.size() < most_tails; speed /= 2) {
    std::optional<Tails> found = tails(equilibrium, speeds, slowest, speed);
    if (!found) return best;
    all.push_back(*std::move(found));
    tails_of_all.push_back({&all.back().energy, all.back().span.length() - length});
    if (all.size() < 3) continue;
    std::optional<RestEnergy> extrapolated =
        RestEnergy::extrapolated(std::span(tails_of_all).last(std::min(most_extrapolated, all.size())),
                                 path_roundoff * speeds.fastest / speed);
    if (!extrapolated) continue;
    if (equilibrium.turns()) {
      const RestEnergy own = *extrapolated;
      const bool comparable = extrapolated->doubt_changes(before ? *before : measured.energy);
      before = own;
      if (!comparable) continue;
    }
    if (extrapolated->action(length, exponent).doubt < best.action(length, exponent).doubt)
      best = *extrapolated;
  }
  return best;
}

/// Of all rests, by e^exponent, with given shifts of the parts between.
Balance::Actions Balance::actions(const Eigen::VectorXd& shifts, double exponent) const {
  const Eigen::VectorXd lengths = lengths_ + by_shifts_ * shifts;
  Actions all{
      .value = 0, .energy = lengths, .stiffness = lengths, .most_stiffness = lengths, .doubt = lengths};
  for (Eigen::Index j = 0; j < lengths.size(); ++j) {
    const Rest& rest = rests_[static_cast<std::size_t>(j)];
    const RestEnergy::Action action = rest.tails.energy.action(lengths[j], exponent);
    if (!(rest.slow.length() + lengths[j] > rest.length())) return {};
    all.value += action.value;
    all.size += std::abs(action.value);
    all.energy[j] = action.energy;
    all.stiffness[j] = action.stiffness;
    all.most_stiffness[j] = action.most_stiffness;
    all.doubt[j] = action.doubt;
  }
  return all;
}

double Balance::largest_log(const Eigen::VectorXd& shifts) const {
  const Eigen::VectorXd lengths = lengths_ + by_shifts_ * shifts;
  double largest = -INFINITY;
  for (std::size_t j = 0; j < rests_.size(); ++j)
    largest = std::max(largest, rests_[j].tails.energy.log_size(lengths[static_cast<Eigen::Index>(j)]));
  return largest;
}

/// Newton's method, damped by the curvature that there were if no terms cancelled: the action falls in each
/// step, also where energies oscillate with the length. Of an exponential function a step is 1/rate, so it is
/// doubled where energies differ by many powers.
std::optional<Eigen::VectorXd> Balance::least_action() const {
  Eigen::VectorXd shifts = Eigen::VectorXd::Zero(by_shifts_.cols());
  double damping = 0, stride = 1, fastest = 0;
  for (const Rest& rest : rests_) fastest = std::max(fastest, rest.tails.energy.fastest_rate());
  const double roundoff = action_roundoff * (1 + fastest * lengths_.sum());
  for (int step = 0; step < most_shift_steps && damping < most_damping; ++step) {
    const double log = largest_log(shifts);
    const Actions now = actions(shifts, -log);
    Eigen::MatrixXd bound = by_shifts_.transpose() * now.most_stiffness.asDiagonal() * by_shifts_;
    bound.diagonal().array() += least_bound * bound.diagonal().maxCoeff();
    const Eigen::LLT<Eigen::MatrixXd> equations(hessian(now) + damping * bound);
    const Eigen::VectorXd change = equations.solve(by_shifts_.transpose() * now.energy);
    const Eigen::VectorXd next = shifts + stride * change;
    const double fall = log - largest_log(next);
    const bool falls = equations.info() == Eigen::Success && (stride == 1 || fall > far) &&
                       actions(next, -log).value <= now.value + roundoff * now.size;
    if (!falls) {
      if (stride == 1) damping = std::max(first_damping, damping_growth * damping);
      stride = 1;
      continue;
    }
    shifts = next;
    if (damping == 0 && stride == 1 && change.cwiseAbs().maxCoeff() * fastest < converged) return shifts;
    stride = fall > far ? 2 * stride : 1;
    damping = damping > least_damping ? damping / damping_growth : 0;
  }
  return std::nullopt;
}

/// Of the action, in the shifts.
Eigen::MatrixXd Balance::hessian(const Actions& rests) const {
  return by_shifts_.transpose() * rests.stiffness.asDiagonal() * by_shifts_;
}

/// Shifts of the parts between rests for which the action of these is least; before the first rest and after
/// the last nothing is shifted.
void Balance::balance() {
  const auto count = std::ssize(rests_);
  if (count < 2) return;
  lengths_.resize(count);
  for (Eigen::Index j = 0; j < count; ++j) lengths_[j] = rests_[static_cast<std::size_t>(j)].length();
  by_shifts_ = Eigen::MatrixXd::Zero(count, count - 1);
  by_shifts_.diagonal().setOnes();
  by_shifts_.diagonal(-1).setConstant(-1);
  const std::optional<Eigen::VectorXd> least = least_action();
  if (!least) return;
  exists_ = true;
  shifts_.assign(least->begin(), least->end());
  shifts_.push_back(0);
  const Eigen::VectorXd longer = by_shifts_ * *least;
  for (Eigen::Index j = 0; j < count; ++j) {
    const Rest& rest = rests_[static_cast<std::size_t>(j)];
    largest_shift_ = std::max(largest_shift_, std::abs(longer[j]) * rest.tails.energy.fastest_rate());
    // With tails that are faster than those measured there may still be a rest.
    const bool long_enough = rest.length() + longer[j] > still_long * rest.length();
    stretched_.push_back(long_enough ? rest.tails.span : rest.slow);
    exists_ = exists_ && stretched_.back().length() + longer[j] > 0;
  }
  const Actions held = actions(*least, -largest_log(*least));
  const Eigen::MatrixXd doubts = by_shifts_.transpose() * held.doubt.asDiagonal();
  energy_ = std::exp(largest_log(*least)) / kinetic_;
  error_ = fastest_ * solved(hessian(held), doubts).cwiseAbs().rowwise().sum().maxCoeff();
}

double Balance::displacement() const {
  double largest = 0;
  for (const double shift : shifts_) largest = std::max(largest, std::abs(shift));
  return fastest_ * largest;
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
    if (excess(rests_[j]) == 0 && rests_[j].tails.energy.held_near(rests_[j].length())) continue;
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

}  // namespace extremal
