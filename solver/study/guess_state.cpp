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
#include "study/guess.hpp"
#include "study/memory.hpp"
#include "study/naming.hpp"

namespace extremal {
namespace {

/// q and q' at t = 0; what is not named is zero.
struct InitialState {
  std::vector<double> q, v;
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

/// Elements that follow more steps than these are not made (limits::guess_mesh); and a guess takes at most
/// this part of memory, as it is copied.
constexpr std::size_t most_steps =
    limits::guess_mesh::most_kept * limits::guess_mesh::samples_an_element / samples_a_step;
constexpr double memory_share = 1.0 / 8;

/// Of the integrator's steps, relative: what they err by is amplified until the end, or until the motion is
/// known better.
template <class Real>
constexpr double tolerance = 1e-14;
template <>
constexpr double tolerance<Extended> = 1e-17;

/// What bounds the integration of a state, and refuses it.
struct Bounds {
  const Problem& problem;
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
    throw SceneError(at, fmt::format("the motion from guess.state {} in the duration {:.6g}; {} steps of the "
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

template <class Real, class AnyFlow>
SampledMotion sample(AnyFlow&& flow, const InitialState& state, double from, double to, const Bounds& bounds,
                     const Anchor<Real>& anchor = {}) {
  SampledMotion samples;
  int taken = 0;
  const auto more = [&, most = bounds.steps()](int steps) {
    taken = steps;
    return steps < most && !bounds.deadline.passed();
  };
  const MotionSampling options{tolerance<Real>, samples_a_step, bounds.problem.duration.value, more};
  if (!sample_motion<Real>(flow, state.q, state.v, from, to, options, samples, anchor))
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
        y_(state.q.begin(), state.q.end()) {
    const std::vector<DoubleDouble> v(state.v.begin(), state.v.end());
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
  static constexpr double step_error = 1e-28;
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

/// Where it takes many steps, with as many digits as L can be evaluated in.
SampledMotion motion_from(const InitialState& state, double from, double to, const Bounds& bounds,
                          const Lagrangian* hamiltonian) {
  const Problem& problem = bounds.problem;
  if (hamiltonian) return sample<double>(StateFlow(*hamiltonian, state.q.size()), state, from, to, bounds);
  SampledMotion samples =
      sample<double>(Flow(problem.motion(), problem.motion_copies()), state, from, to, bounds);
  const Lagrangian& lagrangian = *problem.lagrangian;
  if (problem.copies) return samples;
  if (samples.tau.size() <= many_steps * samples_a_step || !ExtendedFlow<DoubleDouble>::suits(lagrangian))
    return samples;
  ExactMotion exact(state, from, lagrangian);
  return sample<Extended>(ExtendedFlow<Extended>(lagrangian), state, from, to, bounds, std::ref(exact));
}

/// Where an orbit that closes arrives.
InitialState closed(const ClosingMap& map, const InitialState& state) {
  const auto n = static_cast<Eigen::Index>(state.q.size());
  const Eigen::VectorXd q = map.r * Eigen::Map<const Eigen::VectorXd>(state.q.data(), n) + map.c;
  const Eigen::VectorXd v = map.r * Eigen::Map<const Eigen::VectorXd>(state.v.data(), n);
  return {{q.begin(), q.end()}, {v.begin(), v.end()}};
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
  const Bounds bounds{problem, deadline, at};
  const InitialState state = read_state(values, system);
  const std::shared_ptr<const Lagrangian> hamiltonian =
      system.hamiltonian ? make_lagrangian(*system.hamiltonian) : nullptr;
  const double duration = problem.duration.value;
  if (problem.periodic) {
    const SampledMotion first = motion_from(state, 0, duration / 2, bounds, hamiltonian.get());
    const SampledMotion second =
        motion_from(closed(closing_map(problem), state), duration, duration / 2, bounds, hamiltonian.get());
    add_halves(first, second, problem.guess);
  } else {
    SampledMotion samples = motion_from(state, 0, duration, bounds, hamiltonian.get());
    problem.guess.tau = std::move(samples.tau);
    problem.guess.q = std::move(samples.q);
  }
  problem.guess.motion = true;
}

}  // namespace extremal
