#include <fmt/format.h>

#include <algorithm>

#include "motion/dop853.hpp"
#include "motion/extended_flow.hpp"
#include "motion/flow.hpp"
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

/// Times from one to another, later or earlier, and q there.
struct Samples {
  std::vector<double> t, q;
};

/// Steps of the integrator, relative: their errors come back amplified by what errors grow over half a
/// period.
template <class Real>
constexpr double tolerance = 1e-14;
template <>
constexpr double tolerance<long double> = 1e-17;

/// The motion from a state at t = `from`, as a flow in (q, p), to t = `to`; no two at one t/duration.
template <class Real, class AnyFlow>
Samples sample(AnyFlow flow, const InitialState& state, double from, double to, double duration,
               const Location& at) {
  const std::size_t n = state.q.size();
  std::vector<Real> y(state.q.begin(), state.q.end()), between(2 * n);
  const std::vector<Real> v(state.v.begin(), state.v.end());
  y.resize(2 * n);
  if (!flow.momentum(std::span(y).first(n), v, from, std::span(y).subspan(n)))
    throw SceneError(at, "L is not finite at the initial state of the guess");
  DormandPrince<Real> method(
      [&flow](Real t, std::span<const Real> x, std::span<Real> slope) { return flow.slope(t, x, slope); },
      static_cast<int>(2 * n));
  IntegrationOptions options;
  options.tolerance = tolerance<Real>;
  options.block = static_cast<int>(n);
  Samples samples;
  // Extended times may be one in double precision.
  const auto add = [&](Real t, const std::vector<Real>& point) {
    const double rounded = static_cast<double>(t);
    if (!samples.t.empty() && samples.t.back() / duration == rounded / duration) return;
    samples.t.push_back(rounded);
    for (std::size_t a = 0; a < n; ++a) samples.q.push_back(static_cast<double>(point[a]));
  };
  add(from, y);
  for (Real t = from, before = from; t != to; before = t) {
    if (method.accept_step(t, y, to, options) != Integrated::done ||
        !method.prepare_interpolation(y, static_cast<int>(y.size())))
      throw SceneError(at,
                       fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}",
                                   static_cast<double>(t)));
    for (int k = 1; k < samples_a_step; ++k) {
      const Real theta = Real(k) / samples_a_step;
      method.interpolate(theta, between);
      add(before + theta * (t - before), between);
    }
    add(t, y);
  }
  return samples;
}

/// Where it takes many steps, in extended precision if L has it.
Samples motion_from(const InitialState& state, double from, double to, const Problem& problem,
                    const Location& at) {
  const Lagrangian& lagrangian = *problem.lagrangian;
  const double duration = problem.duration.value;
  Samples samples = sample<double>(Flow(lagrangian), state, from, to, duration, at);
  if (samples.t.size() > many_steps * samples_a_step && ExtendedFlow::suits(lagrangian))
    samples = sample<long double>(ExtendedFlow(lagrangian), state, from, to, duration, at);
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
void add_halves(const Samples& first, const Samples& second, double duration, Guess& guess) {
  const std::size_t n = first.q.size() / first.t.size();
  const auto add = [&](const Samples& half, std::size_t k, double weight) {
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
    const Samples first = motion_from(state, 0, duration / 2, problem, at);
    const Samples second =
        motion_from(closed(closing_map(problem), state), duration, duration / 2, problem, at);
    add_halves(first, second, duration, problem.guess);
  } else {
    const Samples samples = motion_from(state, 0, duration, problem, at);
    for (const double t : samples.t) problem.guess.tau.push_back(t / duration);
    problem.guess.q = samples.q;
  }
  problem.guess.motion = true;
}

}  // namespace extremal
