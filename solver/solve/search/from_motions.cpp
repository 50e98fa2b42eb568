#include "solve/search/from_motions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "machine/bisect.hpp"
#include "motion/flow.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/motion_scan.hpp"
#include "solve/search/settled_motion.hpp"

namespace extremal {

using namespace limits::from_motions;

namespace {

/// With one coordinate the way by which motions miss the end is a function of one number. Where its sign
/// changes there is an extremal, or a velocity from which the end is not continuous; no derivative is needed,
/// so that kinks of L do no harm.
bool from_bracketed_motions(Pursuit& pursuit, GuessMesh& guess, double mean, double fastest) {
  const Problem& problem = pursuit.problem;
  if (problem.coordinates() != 1 || problem.duration.free) return false;
  const double duration = problem.duration.value;
  const auto more = [&] { return !pursuit.options.deadline.passed(); };
  const auto motion = [&](double v) {
    return motion_from(*problem.lagrangian, {guess.ends().data(), 1}, {&v, 1}, duration, step_error, more);
  };
  const auto miss = [&](double v) {
    const Guess there = motion(v);
    return there.given() ? there.q.back() - guess.ends()[1] : NAN;
  };
  double low = mean - fastest, low_miss = miss(low);
  for (int k = 1; k <= velocities && more(); ++k) {
    const double high = mean + fastest * (2.0 * k / velocities - 1), high_miss = miss(high);
    if (low_miss * high_miss <= 0) {
      const auto alike = [&](double v) { return miss(v) * low_miss > 0; };
      const Guess arriving = motion(bisect(low, high, most_bisections, alike).low);
      if (arriving.given() && refine_motion(pursuit, guess, arriving, duration, from_arrival)) return true;
    }
    low = high;
    low_miss = high_miss;
  }
  return false;
}

}  // namespace

/// The ends that it misses are moved along a line to those wanted, while the path stays an extremal.
Trial move_to_ends(Pursuit& pursuit, const std::vector<double>& wanted, const Guess& motion,
                   double duration) {
  const Problem& problem = pursuit.problem;
  const std::size_t n = problem.coordinates();
  Problem launched = problem;
  launched.guess = motion;
  std::vector<double> ends = wanted, missed(2 * n);
  double distance = 0;
  for (std::size_t a = 0; a < n; ++a) {
    ends[n + a] = motion.q[motion.q.size() - n + a];
    missed[n + a] = ends[n + a] - wanted[n + a];
    distance = std::hypot(distance, missed[n + a]);
  }
  if (!(distance > 0)) return Trial::none;
  for (double& x : missed) x /= distance;
  const auto fill = [&](const ElementTables& tables, Path& path) {
    path.set_duration(duration);
    start_path(launched, ends, tables, path);
  };
  if (!open_fitting(pursuit, fill, limits::search::homotopy_degree)) return Trial::none;
  EndHomotopy homotopy(
      problem, pursuit.path, pursuit.w, [&] { return pursuit.count_step(); }, missed,
      scales(pursuit.path, pursuit.tables()).q);
  if (!homotopy.trace(pursuit.tables(), distance)) return Trial::in_vain;
  pursuit.refinement.rebind();
  return Trial::found;
}

bool refine_motion(Pursuit& pursuit, GuessMesh& guess, const Guess& motion, double duration,
                   const char* strategy) {
  if (pursuit.exhausted()) return false;
  Problem launched = pursuit.problem;
  launched.guess = motion;
  launched.duration.value = duration;
  return guess.instead(launched, [&] {
    if (guess.begin(pursuit) == GuessMesh::Kind::undefined) return false;
    pursuit.path.set_duration(duration);
    return pursuit.conclude(guess.pursue(pursuit, strategy).converged());
  });
}

bool refine_open_motion(Pursuit& pursuit, GuessMesh& guess, const Guess& motion, const char* strategy) {
  Problem launched = pursuit.problem;
  launched.guess = motion;
  return pursuit.conclude(guess.instead(launched, [&] {
    return guess.begin(pursuit) != GuessMesh::Kind::undefined && pursuit.found(strategy);
  }));
}

/// The longer a path, the fewer lines come near one; and each extremal is tied to motions by the ends
/// between.
Trial from_motions(Pursuit& pursuit, GuessMesh& guess, int kept) {
  const Problem& problem = pursuit.problem;
  const Duration& given = problem.duration;
  if (problem.periodic || problem.ends.free > 0 || (given.free && !given.energy)) return Trial::none;
  if (problem.paired || !Flow::suits(*problem.lagrangian)) return Trial::none;
  pursuit.refinement.allow(
      std::min(pursuit.allowance(), pursuit.options.max_iterations - pursuit.outcome.attempts - kept));
  const std::size_t n = problem.coordinates();
  const double frequency = guess.phase() / given.value;
  const std::vector<double> extent = extents(pursuit.path, negligible_extent[0]);
  const std::vector<double>& ends = guess.ends();
  const std::vector<double> from(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(n));
  const auto count = [&] { return pursuit.count_step(); };
  if (from_bracketed_motions(pursuit, guess, (ends[n] - ends[0]) / given.value,
                             *std::ranges::max_element(speeds) * frequency * extent[0]))
    return Trial::found;
  Trial trial = Trial::none;
  for (unsigned seed = 0; seed < most_motions && !pursuit.exhausted(); ++seed) {
    Noise noise(seed);
    const double duration = given.value * (given.free ? durations[seed % std::size(durations)] : 1);
    std::vector<double> v(n);
    for (std::size_t a = 0; a < n; ++a)
      v[a] = (ends[n + a] - ends[a]) / duration +
             speeds[seed % std::size(speeds)] * frequency * extent[a] * noise();
    if (given.free && !scale_to_energy(*problem.lagrangian, from, *given.energy, v)) continue;
    const Guess motion = motion_from(*problem.lagrangian, from, v, duration, step_error, count);
    if (!motion.given()) continue;
    const Trial moved = move_to_ends(pursuit, ends, motion, duration);
    if (moved != Trial::none) trial = Trial::in_vain;
    if (moved == Trial::found && pursuit.found(from_motion)) return Trial::found;
  }
  return trial;
}

bool from_settled_motion(Pursuit& pursuit, GuessMesh& guess) {
  if (!SettledMotion::suits(pursuit.problem) || pursuit.exhausted()) return false;
  int steps = 0;
  SettledMotion settled(pursuit.problem, [&] {
    return ++steps < limits::settled_motion::most_settling_steps && !pursuit.options.deadline.passed();
  });
  return settled.run() && refine_motion(pursuit, guess, settled.orbit(), settled.duration(),
                                        "newton from the motion that the guess tends to");
}

}  // namespace extremal
