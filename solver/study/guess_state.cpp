#include <fmt/format.h>

#include <algorithm>

#include "motion/extended_flow.hpp"
#include "motion/flow.hpp"
#include "motion/sample.hpp"
#include "problem/closing.hpp"
#include "study/guess.hpp"
#include "study/naming.hpp"

namespace extremal {
namespace {

/// q and q' at t = 0; what is not named is zero.
struct InitialState {
  std::vector<double> q, v;
};

InitialState read_state(const std::vector<Assignment>& values, const System& system) {
  InitialState state{std::vector<double>(system.names.size(), 0),
                     std::vector<double>(system.names.size(), 0)};
  for (const Assignment& a : values) {
    const bool velocity = !a.name.empty() && a.name.back() == '\'';
    const std::string name = velocity ? a.name.substr(0, a.name.size() - 1) : a.name;
    for_each_value(a, range_of(name, a.name_at, system), [&](int coordinate, const Quantity& q) {
      (velocity ? state.v : state.q)[coordinate] = evaluate(q, system.parameters);
    });
  }
  return state;
}

/// Cubic interpolation between so many samples of a step keeps about six digits.
constexpr int samples_a_step = 64;
/// Roundoff of so many steps is amplified by the encounters that they follow.
constexpr std::size_t many_steps = 750;

/// Steps of the integrator, relative: their errors come back amplified by what errors grow over half a
/// period.
template <class Real>
constexpr double tolerance = 1e-14;
template <>
constexpr double tolerance<long double> = 1e-17;

template <class Real, class AnyFlow>
SampledMotion sample(const InitialState& state, double from, double to, const Problem& problem,
                     const Location& at) {
  SampledMotion samples;
  const MotionSampling options{tolerance<Real>, samples_a_step, problem.duration.value};
  if (sample_motion<Real>(AnyFlow(*problem.lagrangian), state.q, state.v, from, to, options, samples))
    return samples;
  if (samples.t.empty()) throw SceneError(at, "L is not finite at the initial state of the guess");
  throw SceneError(at, fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}",
                                   samples.t.back()));
}

/// Where it takes many steps, in extended precision if L has it.
SampledMotion motion_from(const InitialState& state, double from, double to, const Problem& problem,
                          const Location& at) {
  SampledMotion samples = sample<double, Flow>(state, from, to, problem, at);
  if (samples.t.size() > many_steps * samples_a_step && ExtendedFlow::suits(*problem.lagrangian))
    samples = sample<long double, ExtendedFlow>(state, from, to, problem, at);
  return samples;
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
void add_halves(const SampledMotion& first, const SampledMotion& second, double duration, Guess& guess) {
  const std::size_t n = first.q.size() / first.t.size();
  const auto add = [&](const SampledMotion& half, std::size_t k, double weight) {
    const double share = half.t.front() == 0 ? half.t[k] : duration - half.t[k];
    guess.tau.push_back(half.t[k] / duration);
    for (std::size_t a = 0; a < n; ++a) {
      const double gap = second.q[second.q.size() - n + a] - first.q[first.q.size() - n + a];
      guess.q.push_back(half.q[k * n + a] + weight * gap * share / duration);
    }
  };
  for (std::size_t k = 0; k < first.t.size(); ++k) add(first, k, 1);
  for (std::size_t k = second.t.size() - 1; k-- > 0;) add(second, k, -1);
}

}  // namespace

void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     Problem& problem) {
  const InitialState state = read_state(values, system);
  const double duration = problem.duration.value;
  if (problem.periodic) {
    const SampledMotion first = motion_from(state, 0, duration / 2, problem, at);
    const SampledMotion second =
        motion_from(closed(closing_map(problem), state), duration, duration / 2, problem, at);
    add_halves(first, second, duration, problem.guess);
  } else {
    const SampledMotion samples = motion_from(state, 0, duration, problem, at);
    for (const double t : samples.t) problem.guess.tau.push_back(t / duration);
    problem.guess.q = samples.q;
  }
  problem.guess.motion = true;
}

}  // namespace extremal
