#include "motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "motion/sample.hpp"

namespace bench {
namespace {

constexpr int most_steps = 20000;
constexpr double integration_tolerance = 1e-13;
/// Of what could be integrated, where not all could.
constexpr double safe_part = 0.7;

/// p·q' − L at t = 0.
double energy_of(const extremal::Lagrangian& lagrangian, const State& state) {
  extremal::Scratch scratch;
  const extremal::PointValues at =
      evaluate_at(lagrangian, state.q, state.v, 0, extremal::Order::gradient, scratch);
  double energy = -at.value;
  for (std::size_t a = 0; a < at.dv.size(); ++a) energy += at.dv[a] * state.v[a];
  return energy;
}

/// Carries (q, p) from 0 to `duration`; the time that was reached.
double carry(extremal::Flow& flow, std::span<double> y, double duration) {
  extremal::Dop853 method(
      [&](double t, std::span<const double> x, std::span<double> slope) { return flow.slope(t, x, slope); },
      static_cast<int>(y.size()));
  double t = 0;
  method.advance(t, y, duration,
                 {.tolerance = integration_tolerance, .block = flow.coordinates(), .max_steps = most_steps});
  return t;
}

}  // namespace

Motion follow(const extremal::Problem& problem, const State& start, double duration) {
  const std::size_t n = start.q.size();
  Motion motion{.start = start, .end = start};
  extremal::Flow flow(problem.motion(), problem.motion_copies());
  std::vector<double> first(start.q);
  first.resize(2 * n);
  if (!flow.momentum(start.q, start.v, 0, std::span(first).subspan(n))) return motion;
  motion.momentum.assign(first.begin() + static_cast<std::ptrdiff_t>(n), first.end());
  motion.starts_without_momentum =
      std::all_of(first.begin() + n, first.end(), [](double p) { return p == 0; });
  motion.energy = energy_of(*problem.lagrangian, start);

  std::vector<double> y = first;
  double reached = carry(flow, y, duration);
  if (reached < duration) {
    duration = safe_part * reached;
    y = first;
    reached = duration > 0 ? carry(flow, y, duration) : 0;
  }
  const std::span<const double> q = std::span<const double>(y).first(n),
                                p = std::span<const double>(y).subspan(n);
  if (!(reached > 0) || reached < duration || !std::isfinite(motion.energy) ||
      !flow.velocity(q, p, duration, motion.end.v))
    return motion;
  motion.end.q.assign(q.begin(), q.end());
  motion.duration = duration;
  return motion;
}

extremal::Guess motion_guess(const extremal::Problem& problem, const State& start, double duration) {
  extremal::SampledMotion samples;
  const bool done = sample_motion<double>(extremal::Flow(problem.motion(), problem.motion_copies()), start.q,
                                          start.v, 0, duration,
                                          {.tolerance = 1e-10,
                                           .a_step = 16,
                                           .unit = duration,
                                           .more = [](int steps) { return steps < most_steps; }},
                                          samples);
  if (!done) return {};
  return {std::move(samples.tau), std::move(samples.q), true};
}

}  // namespace bench
