#include <algorithm>
#include <cmath>
#include <utility>

#include "machine/bisect.hpp"
#include "motion/flow.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/motion_scan.hpp"
#include "solve/search/search.hpp"
#include "solve/search/settled_motion.hpp"

/// \file Motions from the start, continued to the end that they miss.

namespace extremal {

using namespace limits::from_motions;

/// The ends that it misses are moved along a line to those wanted, while the path stays an extremal.
bool Search::connect(const Guess& motion, double duration) {
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
  return true;
}

bool Search::refine_motion(const Guess& motion, double duration, const char* strategy) {
  if (refinement_.exhausted()) return false;
  Problem launched = problem_;
  launched.guess = motion;
  launched.duration.value = duration;
  guess_ = &launched;
  bool result = false;
  if (begin() != GuessKind::undefined) {
    path_.set_duration(duration);
    result = pursue_guess(strategy).result == Refinement::Result::converged;
    outcome_.status = result ? Status::converged : Status::not_converged;
  }
  guess_ = &problem_;
  return result;
}

bool Search::close(const Guess& motion, const char* strategy) {
  Problem launched = problem_;
  launched.guess = motion;
  guess_ = &launched;
  const bool result = begin() != GuessKind::undefined && found(strategy);
  outcome_.status = result ? Status::converged : Status::not_converged;
  guess_ = &problem_;
  return result;
}

/// With one coordinate the way by which motions miss the end is a function of one number. Where its sign
/// changes there is an extremal, or a velocity from which the end is not continuous; no derivative is needed,
/// so that kinks of L do no harm.
bool Search::from_bracketed_motions(double mean, double fastest) {
  if (problem_.coordinates() != 1 || problem_.duration.free) return false;
  const double duration = problem_.duration.value;
  const auto more = [this] { return !options_.deadline.passed(); };
  const auto motion = [&](double v) {
    return motion_from(*problem_.lagrangian, {ends_.data(), 1}, {&v, 1}, duration, step_error, more);
  };
  const auto miss = [&](double v) {
    const Guess there = motion(v);
    return there.given() ? there.q.back() - ends_[1] : NAN;
  };
  double low = mean - fastest, low_miss = miss(low);
  for (int k = 1; k <= velocities && more(); ++k) {
    const double high = mean + fastest * (2.0 * k / velocities - 1), high_miss = miss(high);
    if (low_miss * high_miss <= 0) {
      const auto alike = [&](double v) { return miss(v) * low_miss > 0; };
      const Guess arriving = motion(bisect(low, high, most_bisections, alike).low);
      if (arriving.given() && refine_motion(arriving, duration, from_arrival)) return true;
    }
    low = high;
    low_miss = high_miss;
  }
  return false;
}

/// A motion satisfies all but the end. The longer a path, the fewer lines come near one; and each extremal is
/// tied to motions by the ends between. As much effort as all before: it finds extremals that they miss.
bool Search::from_motions() {
  const Duration& given = problem_.duration;
  if (problem_.periodic || problem_.ends.free > 0 || (given.free && !given.energy)) return false;
  if (problem_.paired || !Flow::suits(*problem_.lagrangian)) return false;
  refinement_.allow(std::min(allowance_, options_.max_iterations - outcome_.attempts - kept_for_forces()));
  const std::size_t n = problem_.coordinates();
  const double frequency = phase_ / given.value;
  const std::vector<double> extent = extents(path_, negligible_extent[0]);
  const std::vector<double> from(ends_.begin(), ends_.begin() + static_cast<std::ptrdiff_t>(n));
  const auto count = [this] { return refinement_.count_step(); };
  if (from_bracketed_motions((ends_[n] - ends_[0]) / given.value,
                             *std::ranges::max_element(speeds) * frequency * extent[0]))
    return true;
  for (unsigned seed = 0; seed < most_motions && !refinement_.exhausted(); ++seed) {
    Noise noise(seed);
    const double duration = given.value * (given.free ? durations[seed % std::size(durations)] : 1);
    std::vector<double> v(n);
    for (std::size_t a = 0; a < n; ++a)
      v[a] = (ends_[n + a] - ends_[a]) / duration +
             speeds[seed % std::size(speeds)] * frequency * extent[a] * noise();
    if (given.free && !scale_to_energy(*problem_.lagrangian, from, *given.energy, v)) continue;
    const Guess motion = motion_from(*problem_.lagrangian, from, v, duration, step_error, count);
    if (motion.given() && connect(motion, duration) && found(from_motion)) return true;
  }
  return false;
}

/// What forces make of the guess in the course of time.
bool Search::from_settled_motion() {
  if (!SettledMotion::suits(problem_) || refinement_.exhausted()) return false;
  int steps = 0;
  SettledMotion settled(problem_, [&] {
    return ++steps < limits::settled_motion::most_settling_steps && !options_.deadline.passed();
  });
  return settled.run() &&
         refine_motion(settled.orbit(), settled.duration(), "newton from the motion that the guess tends to");
}

}  // namespace extremal
