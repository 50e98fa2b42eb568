#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/flow.hpp"
#include "motion/sample.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/search.hpp"

/// \file Motions from the start, continued to the end that they miss.

namespace extremal {

using namespace limits::from_motions;

namespace {

/// Scales a velocity so that q'·∂L/∂q' − L is the energy: its derivative by the logarithm of the scale is
/// q'·(∂²L/∂q'∂q')q'. False if no scale does.
bool scale_to_energy(const Lagrangian& lagrangian, std::span<const double> q, double energy,
                     std::span<double> v) {
  Scratch scratch;
  const std::size_t n = v.size();
  for (int step = 0; step < most_energy_steps; ++step) {
    const PointValues at = evaluate_at(lagrangian, q, v, 0, Order::hessian, scratch);
    double excess = -at.value - energy, size = std::abs(at.value) + std::abs(energy), slope = 0;
    for (std::size_t a = 0; a < n; ++a) {
      excess += v[a] * at.dv[a];
      size += std::abs(v[a] * at.dv[a]);
      for (std::size_t b = 0; b < n; ++b) slope += v[a] * at.vv[a * n + b] * v[b];
    }
    if (std::abs(excess) <= energy_error * size) return true;
    if (!(slope > 0) || !std::isfinite(excess)) return false;
    const double scale = std::max(0.1, 1 - excess / slope);
    for (double& x : v) x *= scale;
  }
  return false;
}

/// The motion from (q, v) at t = 0; none where the integration fails, or `count` allows no more steps.
Guess motion_from(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                  double duration, const std::function<bool()>& count) {
  const auto more = [&count](int steps) {
    return steps < most_integrator_steps && (steps % steps_a_count > 0 || count());
  };
  SampledMotion samples;
  if (!sample_motion<double>(Flow(lagrangian), q, v, 0, duration,
                             {step_error, samples_a_step, duration, more}, samples))
    return {};
  return {std::move(samples.tau), std::move(samples.q), true};
}

}  // namespace

/// The ends that it misses are moved along a line to those wanted, while the path stays an extremal.
bool Search::from_motion(const Guess& motion, double duration) {
  const std::size_t n = problem_.coordinates();
  Problem launched = problem_;
  launched.guess = motion;
  std::vector<double> ends = ends_, missed(2 * n);
  double distance = 0;
  for (std::size_t a = 0; a < n; ++a) {
    ends[n + a] = motion.q[motion.q.size() - n + a];
    missed[n + a] = ends[n + a] - ends_[n + a];
    distance = std::hypot(distance, missed[n + a]);
  }
  if (!(distance > 0)) return false;
  for (double& x : missed) x /= distance;
  const auto fill = [&](const ElementTables& tables, Path& path) {
    path.set_duration(duration);
    start_path(launched, ends, tables, path);
  };
  if (!open_fitting(fill, homotopy_degree)) return false;
  met_.insert(Met::motions);
  EndHomotopy homotopy(
      problem_, path_, w_, [this] { return refinement_.count_step(); }, missed,
      scales(path_, refinement_.tables()).q);
  if (!homotopy.trace(refinement_.tables(), distance)) return false;
  refinement_.rebind();
  return found("homotopy in the ends from a motion");
}

/// A motion satisfies all but the end. The longer a path, the fewer lines come near one; and each extremal is
/// tied to motions by the ends between. As much effort as all before: it finds extremals that they miss.
bool Search::from_motions() {
  const Duration& given = problem_.duration;
  if (problem_.periodic || problem_.ends.free > 0 || (given.free && !given.energy)) return false;
  if (!Flow::suits(*problem_.lagrangian)) return false;
  refinement_.allow(std::min(allowance_, options_.max_iterations - outcome_.attempts));
  const std::size_t n = problem_.coordinates();
  const double frequency = std::max(1.0, w_.frequency.phase()) / given.value;
  const std::vector<double> extent = extents(path_, negligible_extent[0]);
  const std::span<const double> from = std::span(ends_).first(n);
  const auto count = [this] { return refinement_.count_step(); };
  for (unsigned seed = 0; seed < most_motions && !refinement_.exhausted(); ++seed) {
    Noise noise(seed);
    const double duration = given.value * (given.free ? durations[seed % std::size(durations)] : 1);
    std::vector<double> v(n);
    for (std::size_t a = 0; a < n; ++a)
      v[a] = (ends_[n + a] - ends_[a]) / duration +
             speeds[seed % std::size(speeds)] * frequency * extent[a] * noise();
    if (given.free && !scale_to_energy(*problem_.lagrangian, from, *given.energy, v)) continue;
    const Guess motion = motion_from(*problem_.lagrangian, from, v, duration, count);
    if (motion.given() && from_motion(motion, duration)) return true;
  }
  return false;
}

}  // namespace extremal
