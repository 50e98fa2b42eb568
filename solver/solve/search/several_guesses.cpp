#include <algorithm>
#include <cmath>

#include "solve/guess/starting_ends.hpp"
#include "solve/homotopy/duration_homotopy.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/newton/ends.hpp"
#include "solve/search/deflation.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/several.hpp"

/// \file Other extremals from other guesses: deflated, downhill, bent, wound, and random loops.

namespace extremal {

using namespace limits::several;

namespace {

/// Noise of growing size and of few modes and many.
Bend bend_of(unsigned seed) {
  constexpr double sizes[] = {0.1, 0.3, 0.6, 1, 1.8};
  constexpr int modes[] = {3, 1, 5, 2, 8, 3, 12};
  return {sizes[seed % std::size(sizes)], seed, modes[seed % std::size(modes)]};
}

/// First about the origin of the coordinates, then about points by the ends.
Arc arc_of(unsigned seed, const std::vector<double>& ends) {
  constexpr int turns[] = {-1, 1, -2, 2, 0, -3, 3};
  constexpr double excesses[] = {0, 0.5, -0.4, 1};
  const std::size_t n = ends.size() / 2;
  const unsigned round = seed / std::size(turns);
  Arc arc{std::vector<double>(n, 0), turns[seed % std::size(turns)], excesses[round % std::size(excesses)]};
  if (round < std::size(excesses)) return arc;
  double extent = 0;
  for (double x : ends) extent = std::max(extent, std::abs(x));
  Noise noise(round);
  for (std::size_t a = 0; a < n; ++a) arc.centre[a] = (ends[a] + ends[n + a]) / 2 + extent * noise();
  return arc;
}

}  // namespace

/// Again from the guess as long as that leads to another.
void Several::deflate() {
  DeflatedNewton newton(problem_, path_, w_, [this] { return pursuit_.count_step(); });
  while (wanted()) {
    const ElementTables& tables = pursuit_.open(guess_.mesh(), family_degree);
    start_path(problem_, guess_.ends(), tables, path_);
    const std::size_t before = found_.size();
    if (!newton.run(tables, found_)) return;
    refine_and_keep(tables, "deflated newton from the guess");
    if (found_.size() == before) return;
  }
}

void Several::guess() {
  const unsigned most = loops_.usable() ? loops : guesses;
  for (unsigned k = 0; k < most && wanted(); ++k, ++seed_, ++in_vain_) {
    if (loops_.usable()) {
      if (loops_.next()) {
        const std::size_t before = found_.size();
        const bool orbit = keep() >= 0;
        if (orbit) loops_.credit();
        if (orbit && found_.size() == before) ++returns_;
      }
      pursuit_.renew();
      continue;
    }
    bend();
    if (problem_.coordinates() > 1 && wanted()) wind();
  }
}

/// Downhill from the guess. Saddles are left both ways along their direction of most negative curvature: a
/// symmetric one for a pair of extremals of less action.
void Several::descend() {
  int arrived = 0;
  const auto take = [&](bool minimum) {
    if (minimum) keep();
    arrived += minimum;
  };
  if (descended_ == 0)
    for (double side : {1.0, -1.0}) take(pursuit_.conclude(search_.flow().run(side)));
  for (int saddles = 0; descended_ < found_.size() && saddles < most_saddles && !pursuit_.exhausted() &&
                        !options_.deadline.passed();
       ++descended_) {
    if (found_[descended_].morse_index.value_or(0) == 0) continue;
    ++saddles;
    const Trajectory saddle = found_[descended_].trajectory;
    for (double side : {-1.0, 1.0}) take(search_.flow().descend_from(saddle, side));
    // The action has no minimum, it seems.
    if (arrived == 0) return;
  }
}

void Several::bend() {
  const Bend bend = bend_of(seed_);
  const ElementTables& tables = pursuit_.open(guess_.mesh(), Refinement::first_degree);
  start_path(problem_, moved_ends(problem_, guess_.ends(), bend.size, seed_), tables, path_);
  bend_path(problem_, bend, tables, path_);
  refine_and_keep(tables, "newton from the guess plus smooth noise");
}

/// A duration in which the action of an arc is stationary against its radius: forces bend it about as much as
/// it is bent. That which is wanted where there is none.
double Several::natural_duration(Arc arc, const ElementTables& tables) {
  constexpr int octaves = 6, steps = 4;  // either side, steps each
  constexpr double small = 1e-3;
  const double excess = arc.excess;
  const auto duration = [&](double k) {
    return problem_.duration.value * std::pow(2.0, k / steps - octaves);
  };
  std::vector<double> slope(2 * octaves * steps + 1, 0);
  for (double side : {-1, 1}) {
    arc.excess = excess + side * small;
    arc_path(arc, guess_.ends(), tables, path_);
    for (std::size_t k = 0; k < slope.size(); ++k) {
      path_.set_duration(duration(static_cast<double>(k)));
      w_.iteration.action().evaluate_plain(path_);
      slope[k] += side * w_.iteration.action().action();
    }
  }
  for (std::size_t k = 0; k + 1 < slope.size(); ++k)
    if (slope[k] * slope[k + 1] < 0)
      return duration(static_cast<double>(k) + slope[k] / (slope[k] - slope[k + 1]));
  return problem_.duration.value;
}

/// An arc of a circle run through in its natural duration; from there through extremals with ends between,
/// and then through those of durations between.
void Several::wind() {
  constexpr const char* strategy = "homotopy from an arc of a circle";
  const auto count = [this] { return pursuit_.count_step(); };
  const Arc arc = arc_of(seed_, guess_.ends());
  const std::vector<double> mesh = uniform_mesh(elements_a_turn * std::max(1, std::abs(arc.turns)));
  const ElementTables& tables = pursuit_.open(mesh, family_degree);
  const bool autonomous = problem_.lagrangian->structure().autonomous;
  const double duration = autonomous ? natural_duration(arc, tables) : problem_.duration.value;
  EndHomotopy ends(problem_, path_, w_, count, arc_path(arc, guess_.ends(), tables, path_), 1);
  path_.set_duration(duration);
  if (!ends.trace(tables, 1)) return;
  meet_ends(problem_, path_);
  DurationHomotopy durations(problem_, path_, w_, count);
  if (problem_.duration.free || !autonomous || durations.trace(tables)) refine_and_keep(tables, strategy);
}

}  // namespace extremal
