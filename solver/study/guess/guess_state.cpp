#include <fmt/format.h>
#include <qd/dd_real.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "motion/extended_flow.hpp"
#include "motion/extrapolation.hpp"
#include "motion/flow.hpp"
#include "motion/sample.hpp"
#include "problem/closing.hpp"
#include "problem/phase_space.hpp"
#include "solve/search/limits.hpp"
#include "study/checks/memory.hpp"
#include "study/guess/closing_correction.hpp"
#include "study/guess/guess.hpp"
#include "study/guess/limits.hpp"
#include "study/guess/marched_state.hpp"
#include "study/model/naming.hpp"

namespace extremal {
namespace {

/// q and q' at t = 0; what is not named is zero.
struct InitialState {
  std::vector<double> q, v;
  std::vector<double> q_low = {}, v_low = {};  ///< to be added to these, of a state that was corrected

  template <class Real>
  std::vector<Real> positions() const {
    return sum<Real>(q, q_low);
  }
  template <class Real>
  std::vector<Real> velocities() const {
    return sum<Real>(v, v_low);
  }

 private:
  template <class Real>
  static std::vector<Real> sum(const std::vector<double>& high, const std::vector<double>& low) {
    std::vector<Real> result(high.begin(), high.end());
    for (std::size_t a = 0; a < low.size(); ++a) result[a] += low[a];
    return result;
  }
};

/// In phase space: q' and p' follow from q and p.
void set_rates(const std::vector<Assignment>& values, const System& system, InitialState& state) {
  for (const Assignment& a : values)
    if (a.name.ends_with('\''))
      throw SceneError(a.name_at,
                       fmt::format("the velocities do not determine the momenta of this Hamiltonian; "
                                   "give momenta, as 'p_{}', instead of \"{}\"",
                                   a.name.substr(0, a.name.size() - 1), a.name));
  Scratch scratch;
  hamilton_equations(*make_lagrangian(*system.hamiltonian), state.q, 0, state.v, scratch);
}

InitialState read_state(const std::vector<Assignment>& values, const System& system) {
  InitialState state{std::vector<double>(system.names.size(), 0),
                     std::vector<double>(system.names.size(), 0)};
  for (const Assignment& a : values) {
    const bool velocity = !a.name.empty() && a.name.back() == '\'';
    const std::string name = velocity ? a.name.substr(0, a.name.size() - 1) : a.name;
    if (name.ends_with('\''))
      throw SceneError(a.name_at, "a second \"'\"; a state has coordinates and velocities");
    for_each_value(a, range_of(name, a.name_at, system), [&](int coordinate, const Quantity& q, int index) {
      (velocity ? state.v : state.q)[coordinate] = evaluate(q, system, index);
    });
  }
  if (system.hamiltonian) set_rates(values, system, state);
  return state;
}

/// Cubic interpolation between so many samples of a step keeps about six digits.
constexpr int samples_a_step = 64;
/// Roundoff of so many steps is amplified by the encounters that they follow.
constexpr std::size_t many_steps = 750;
/// Steps between points that are kept.
constexpr int steps_a_point = 8;

/// Elements that follow more steps than these are not made (limits::guess_mesh); and a guess takes at most
/// this part of memory, as it is copied.
constexpr std::size_t most_steps = limits::guess_mesh::most_kept * limits::guess_mesh::steps_an_element;
constexpr double memory_share = 1.0 / 8;

/// Of the integrator's steps, relative: what they err by is amplified until the end, or until the motion is
/// known better.
template <class Real>
constexpr double tolerance = 1e-14;
template <>
constexpr double tolerance<Extended> = 1e-17;

/// Halves of an orbit meet after at least this part of the first.
constexpr double earliest_meeting = 0.5;

/// An integration that takes more steps than elements can follow.
struct TooManySteps : SceneError {
  using SceneError::SceneError;
};

/// What bounds the integration of a state, and refuses it.
struct Bounds {
  const Problem& problem;
  const Lagrangian* hamiltonian;  ///< in phase space
  Deadline deadline;
  Location at;

  int steps() const {
    const double of_step = samples_a_step * sizeof(double) * (problem.coordinates() + 1.0);
    return static_cast<int>(std::min<double>(most_steps, memory_share * available_bytes() / of_step));
  }

  /// The motion was followed from `from` as far as the samples go.
  [[noreturn]] void refuse(const SampledMotion& samples, double from, int steps_taken) const {
    if (samples.tau.empty()) throw SceneError(at, "L is not finite at the initial state of the guess");
    const double reached = samples.tau.back() * problem.duration.value;
    if (deadline.passed())
      throw SceneError(
          at, fmt::format("{} (solve.budget) is spent at t = {:.6g} of the motion from guess.state; raise "
                          "it, or shorten the duration",
                          deadline.budget_text(), reached));
    if (steps_taken < steps())
      throw SceneError(
          at, fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}", reached));
    const double duration = problem.duration.value, turned = oscillations(samples);
    const std::string makes = turned > 0 ? fmt::format("makes about {:.2g} oscillations",
                                                       turned * duration / std::abs(reached - from))
                                         : "takes too many steps";
    throw TooManySteps(at,
                       fmt::format("the motion from guess.state {} in the duration {:.6g}; {} steps of the "
                                   "integrator, the most that elements can follow, lead to t = {:.6g}; "
                                   "shorten the duration",
                                   makes, duration, steps_taken, reached));
  }

 private:
  /// Half the number of turning points of the coordinate that turns most often.
  double oscillations(const SampledMotion& samples) const {
    const std::size_t n = problem.coordinates();
    std::size_t most = 0;
    for (std::size_t a = 0; a < n; ++a) {
      std::size_t turns = 0;
      double before = 0;
      for (std::size_t k = n + a; k < samples.q.size(); k += n) {
        const double change = samples.q[k] - samples.q[k - n];
        turns += change * before < 0;
        if (change != 0) before = change;
      }
      most = std::max(most, turns);
    }
    return 0.5 * static_cast<double>(most);
  }
};

/// A motion, and (q, p) between some of its steps, at its start and its end.
struct FollowedMotion : SampledMotion {
  MotionPoints points;
};

template <class Real, class AnyFlow>
FollowedMotion sample(AnyFlow&& flow, const InitialState& state, double from, double to, const Bounds& bounds,
                      const Anchor<Real>& anchor = {}) {
  FollowedMotion samples;
  const std::size_t size = 2 * state.q.size();
  int taken = 0;
  const auto keep = [&](Real t, std::span<const Real> y) {
    samples.points.t.push_back(t);
    samples.points.y.insert(samples.points.y.end(), y.begin(), y.begin() + static_cast<std::ptrdiff_t>(size));
  };
  const auto keep_some = [&](Real t, std::span<Real> y) {
    const bool on = !anchor || anchor(t, y);
    if ((taken + 1) % steps_a_point == 0 || t == Real(to)) keep(t, y);
    return on;
  };
  const auto more = [&, most = bounds.steps()](int steps) {
    taken = steps;
    return steps < most && !bounds.deadline.passed();
  };
  const std::vector<Real> q = state.positions<Real>(), v = state.velocities<Real>();
  std::vector<Real> start = q;
  start.resize(size);
  if (flow.momentum(std::span(start).first(size / 2), v, from, std::span(start).subspan(size / 2)))
    keep(from, start);
  const MotionSampling options{tolerance<Real>, samples_a_step, bounds.problem.duration.value, more};
  if (!sample_motion<Real>(flow, q, v, from, to, options, samples, keep_some))
    bounds.refuse(samples, from, taken);
  return samples;
}

/// The same motion in twice the precision, from where samples begin anew.
class ExactMotion {
 public:
  ExactMotion(const InitialState& state, double from, const Lagrangian& lagrangian)
      : flow_(lagrangian),
        method_([this](DoubleDouble t, auto y, auto slope) { return flow_.slope(t, y, slope); },
                static_cast<int>(2 * state.q.size())),
        t_(from),
        y_(state.positions<DoubleDouble>()) {
    const auto v = state.velocities<DoubleDouble>();
    y_.resize(2 * v.size());
    flow_.momentum(std::span(y_).first(v.size()), v, t_, std::span(y_).subspan(v.size()));
  }
  ExactMotion(const ExactMotion&) = delete;

  /// An anchor, as far as it can be followed.
  bool operator()(Extended t, std::span<Extended> y) {
    if (!followed_ || ++steps_ % steps_between != 0) return true;
    const DoubleDouble to = wide(t);
    followed_ = method_.advance(t_, y_, to - t_, step_error);
    if (!followed_) return true;
    t_ = to;
    std::transform(y_.begin(), y_.end(), y.begin(),
                   [](const DoubleDouble& x) { return static_cast<Extended>(x.x[0]) + x.x[1]; });
    return true;
  }

 private:
  static constexpr double step_error = 1e-25;
  /// So many are one of extrapolation.
  static constexpr int steps_between = 4;
  static DoubleDouble wide(Extended t) {
    const auto high = static_cast<double>(t);
    return {high, static_cast<double>(t - high)};
  }

  ExtendedFlow<DoubleDouble> flow_;
  Extrapolation method_;
  DoubleDouble t_;
  std::vector<DoubleDouble> y_;
  int steps_ = 0;
  bool followed_ = true;
};

/// Hamilton's equations for states z = (q, p), which have no momenta beside them.
class StateFlow {
 public:
  StateFlow(const Lagrangian& hamiltonian, std::size_t size) : hamiltonian_(hamiltonian), size_(size) {}

  bool momentum(std::span<const double> z, std::span<const double>, double t, std::span<double> unused) {
    std::ranges::fill(unused, 0.0);
    std::vector<double> rate(size_);
    return rates(z, t, rate);
  }
  bool slope(double t, std::span<const double> y, std::span<double> slope) {
    std::ranges::fill(slope, 0.0);
    return rates(y.first(size_), t, slope.first(size_));
  }

 private:
  bool rates(std::span<const double> z, double t, std::span<double> rate) {
    hamilton_equations(hamiltonian_, z, t, rate, scratch_);
    return std::ranges::all_of(rate, [](double x) { return std::isfinite(x); });
  }

  const Lagrangian& hamiltonian_;
  std::size_t size_;
  Scratch scratch_;
};

FollowedMotion double_motion(const InitialState& state, double from, double to, const Bounds& bounds) {
  if (bounds.hamiltonian)
    return sample<double>(StateFlow(*bounds.hamiltonian, state.q.size()), state, from, to, bounds);
  return sample<double>(Flow(bounds.problem.motion(), bounds.problem.motion_copies()), state, from, to,
                        bounds);
}

FollowedMotion exact_motion(const InitialState& state, double from, double to, const Bounds& bounds) {
  const Lagrangian& lagrangian = *bounds.problem.lagrangian;
  ExactMotion exact(state, from, lagrangian);
  return sample<Extended>(ExtendedFlow<Extended>(lagrangian), state, from, to, bounds, std::ref(exact));
}

/// Whether motions can be followed with more digits.
bool has_digits(const Bounds& bounds) {
  return !bounds.hamiltonian && !bounds.problem.copies &&
         ExtendedFlow<DoubleDouble>::suits(*bounds.problem.lagrangian);
}

/// Whether a motion takes more steps than its digits are good for, and more digits are known.
bool asks_for_digits(const SampledMotion& samples, const Bounds& bounds) {
  return samples.tau.size() > many_steps * samples_a_step && has_digits(bounds);
}

/// Where it takes many steps, with as many digits as L can be evaluated in.
FollowedMotion motion_from(const InitialState& state, double from, double to, const Bounds& bounds) {
  FollowedMotion samples = double_motion(state, from, to, bounds);
  return asks_for_digits(samples, bounds) ? exact_motion(state, from, to, bounds) : samples;
}

/// Where an orbit that closes arrives.
InitialState closed(const ClosingMap& map, const InitialState& state) {
  const auto image = [&](const std::vector<double>& x) -> std::vector<double> {
    const Eigen::VectorXd y = map.r * Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x));
    return {y.begin(), y.end()};
  };
  InitialState result{image(state.q), image(state.v)};
  for (std::size_t a = 0; a < result.q.size(); ++a) result.q[a] += map.c[static_cast<Eigen::Index>(a)];
  if (!state.q_low.empty()) result.q_low = image(state.q_low), result.v_low = image(state.v_low);
  return result;
}

/// Both halves of an orbit.
struct Halves {
  FollowedMotion first, second;
  bool hopeless = false;  ///< they miss each other by more than any digits

  /// By how much they miss each other.
  PhasePoint apart() const {
    const std::vector<Extended>&a = first.points.y, &b = second.points.y;
    const std::size_t size = a.size() / first.points.t.size();
    PhasePoint result(static_cast<Eigen::Index>(size));
    for (std::size_t i = 1; i <= size; ++i)
      result[result.size() - static_cast<Eigen::Index>(i)] =
          static_cast<double>(a[a.size() - i] - b[b.size() - i]);
    return result;
  }
  /// Relative to the largest |q| and |p| there.
  double gap() const {
    const PhasePoint apart = this->apart();
    const auto n = static_cast<std::size_t>(apart.size() / 2);
    double largest = 0;
    for (std::size_t part = 0; part < 2; ++part) {
      double size = 0, gap = 0;
      for (std::size_t e = 0; e < n; ++e) {
        const std::size_t at = part * n + e;
        size = std::max(size, static_cast<double>(std::abs(*(first.points.y.end() - 2 * n + at))));
        gap = std::max(gap, std::abs(apart[static_cast<Eigen::Index>(at)]));
      }
      if (gap > 0) largest = std::max(largest, gap / size);
    }
    return largest;
  }
};

/// The end of the longest step in the second part of a motion: there it is nearly free, and what is apart
/// there is not amplified by an encounter.
double quietest(const SampledMotion& samples) {
  const std::vector<double>& tau = samples.tau;
  double longest = 0, at = tau.back();
  for (std::size_t k = samples_a_step; k < tau.size(); k += samples_a_step) {
    const double length = tau[k] - tau[k - samples_a_step];
    if (tau[k] >= earliest_meeting * tau.back() && length > longest) longest = length, at = tau[k];
  }
  return at;
}

/// The state moved by (δq, δp), to more digits than doubles have: encounters amplify the last of those. The
/// system is one that ExtendedFlow suits.
InitialState moved(const InitialState& state, const PhasePoint& change, const Lagrangian& lagrangian) {
  ExtendedFlow<Extended> flow(lagrangian);
  const std::size_t n = state.q.size();
  std::vector<Extended> y = state.positions<Extended>(), v = state.velocities<Extended>();
  y.resize(2 * n);
  flow.momentum(std::span(y).first(n), v, 0, std::span(y).subspan(n));
  for (std::size_t e = 0; e < y.size(); ++e) y[e] += change[static_cast<Eigen::Index>(e)];
  flow.velocity(y, v);
  InitialState result;
  const auto split = [](std::span<const Extended> x, std::vector<double>& high, std::vector<double>& low) {
    for (const Extended a : x) {
      high.push_back(static_cast<double>(a));
      low.push_back(static_cast<double>(a - high.back()));
    }
  };
  split(std::span(y).first(n), result.q, result.q_low);
  split(v, result.v, result.v_low);
  return result;
}

/// A state given to ten digits may lead to encounters later or earlier than a closed orbit does, by more than
/// they last. The state is corrected by shooting as long as corrections become shorter, with one
/// factorisation where that is by much (natural monotonicity: Deuflhard, Newton Methods for Nonlinear
/// Problems, 3.3). What is solved for stays the stationary point of S_h near this motion.
Halves closed_halves(InitialState state, const Bounds& bounds) {
  using namespace limits::closing_correction;
  const double duration = bounds.problem.duration.value;
  const ClosingMap map = closing_map(bounds.problem);
  FollowedMotion first = double_motion(state, 0, duration / 2, bounds);
  if (!asks_for_digits(first, bounds)) {
    Halves near{std::move(first), motion_from(closed(map, state), duration, duration / 2, bounds)};
    const double gap = near.gap();
    if (gap <= easily_closed || !(gap <= most_apart) || !has_digits(bounds)) return near;
    first = std::move(near.first);
  }
  const double meeting = quietest(first) * duration;
  const auto halves_from = [&](const InitialState& start) -> Halves {
    return {exact_motion(start, 0, meeting, bounds),
            exact_motion(closed(map, start), duration, meeting, bounds)};
  };
  Halves halves = halves_from(state);
  halves.hopeless = !(halves.gap() <= most_apart);
  if (halves.hopeless || halves.gap() <= easily_closed) return halves;
  const auto correction_of = [&bounds](const Halves& found) {
    return ClosingCorrection(bounds.problem, found.first.points, found.second.points, bounds.deadline);
  };
  ClosingCorrection correction = correction_of(halves);
  if (!correction.valid()) return halves;
  PhasePoint change = correction.change(halves.apart());
  for (int k = 0; k < most_corrections && halves.gap() > closed_well; ++k) {
    const double size = correction.size(change);
    if (!(size > last_digits)) break;
    state = moved(state, change, *bounds.problem.lagrangian);
    Halves better = halves_from(state);
    change = correction.change(better.apart());
    const double gain = correction.size(change) / size;
    if (!(gain <= least_gain)) break;
    halves = std::move(better);
    if (gain <= good_gain) continue;
    correction = correction_of(halves);
    if (!correction.valid()) break;
    change = correction.change(halves.apart());
  }
  return halves;
}

/// The duration that is free, moved to where the motion comes nearest to where it has to arrive, to first
/// order again and again; the same where it does not come nearer. An encounter may last less than a digit of
/// the duration that is given.
double return_time(const InitialState& state, Problem problem, const Bounds& bounds) {
  using namespace limits::return_time;
  const double given = problem.duration.value;
  const InitialState goal = closed(closing_map(problem), state);
  Flow flow(problem.motion(), problem.motion_copies());
  const std::size_t n = state.q.size();
  std::vector<double> wanted = goal.q, slope(2 * n);
  wanted.resize(2 * n);
  if (!flow.momentum(goal.q, goal.v, 0, std::span(wanted).subspan(n))) return given;
  const Bounds moved{problem, bounds.hamiltonian, bounds.deadline, bounds.at};
  double best = given, least = INFINITY;
  for (int k = 0; k < most_returns; ++k) {
    const FollowedMotion motion = double_motion(state, 0, problem.duration.value, moved);
    const std::vector<Extended>& points = motion.points.y;
    std::vector<double> y(points.end() - static_cast<std::ptrdiff_t>(2 * n), points.end());
    if (!flow.slope(problem.duration.value, y, slope)) break;
    double along = 0, speed = 0, apart = 0;
    for (const std::size_t part : {std::size_t{0}, n}) {
      double size = 0;
      for (std::size_t a = part; a < part + n; ++a) size = std::max(size, std::abs(wanted[a]));
      if (size == 0) continue;
      for (std::size_t a = part; a < part + n; ++a) {
        const double missed = (wanted[a] - y[a]) / size, rate = slope[a] / size;
        along += missed * rate;
        speed += rate * rate;
        apart += missed * missed;
      }
    }
    if (!(apart < gain * least) || !(speed > 0)) break;
    least = apart;
    best = problem.duration.value;
    const double next = best + along / speed;
    if (!(std::abs(next - given) <= farthest * given)) break;
    problem.duration.value = next;
  }
  return best;
}

/// Of an orbit that closes only the first half is integrated onwards; the second is integrated back from
/// where it has to arrive: errors grow for half as long. Halfway each gives way to the other.
void add_halves(const SampledMotion& first, const SampledMotion& second, Guess& guess) {
  const std::size_t n = first.q.size() / first.tau.size();
  const auto add = [&](const SampledMotion& half, std::size_t k, double weight) {
    const double share = half.tau.front() == 0 ? half.tau[k] : 1 - half.tau[k];
    guess.tau.push_back(half.tau[k]);
    for (std::size_t a = 0; a < n; ++a) {
      const double gap = second.q[second.q.size() - n + a] - first.q[first.q.size() - n + a];
      guess.q.push_back(half.q[k * n + a] + weight * gap * share);
    }
  };
  for (std::size_t k = 0; k < first.tau.size(); ++k) add(first, k, 1);
  for (std::size_t k = second.tau.size() - 1; k-- > 0;) add(second, k, -1);
}

}  // namespace

void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     const Deadline& deadline, Problem& problem) {
  const InitialState state = read_state(values, system);
  const std::shared_ptr<const Lagrangian> hamiltonian =
      system.hamiltonian ? make_lagrangian(*system.hamiltonian) : nullptr;
  const Bounds bounds{problem, hamiltonian.get(), deadline, at};
  const double duration = problem.duration.value;
  try {
    if (problem.periodic) {
      Halves halves = closed_halves(state, bounds);
      if (!(halves.gap() <= limits::closing_correction::most_apart) && problem.duration.free &&
          !hamiltonian) {
        problem.duration.value = return_time(state, problem, bounds);
        if (problem.duration.value != duration) halves = closed_halves(state, bounds);
      }
      add_halves(halves.first, halves.second, problem.guess);
      problem.guess.samples_a_step = halves.hopeless ? 0 : samples_a_step;
    } else {
      SampledMotion samples = motion_from(state, 0, duration, bounds);
      problem.guess.tau = std::move(samples.tau);
      problem.guess.q = std::move(samples.q);
      problem.guess.samples_a_step = samples_a_step;
    }
  } catch (const TooManySteps&) {
    std::optional<Guess> motion = motion_across_kinks(problem, state.q, state.v, deadline);
    if (!motion) throw;
    problem.guess = *std::move(motion);
  }
}

}  // namespace extremal
