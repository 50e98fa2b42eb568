#include "solve/branch/continuation.hpp"
#include "solve/mesh/roundoff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace extremal {

namespace {

/// Lengths are relative, as Branch::dot measures them.
constexpr double least_length = 1e-6;
/// A step is refused where corrections shrink less than this or are longer than this part of it; the next try
/// is so much of it.
constexpr double contraction = 0.5, longest_correction = 0.5, shortening = 0.4;
/// Corrections shorter than this part of a step hardly move the path, but where that is short, as near a
/// singularity: they may grow so much before they shrink.
constexpr double small_correction = 0.05, slowest = 4;
constexpr int most_corrections = 8, most_resolutions = 4;
/// Steps whose last corrections take more factors are too long.
constexpr int many_factors = 4;
/// Corrections are carried on no further than this.
constexpr double least_goal = 10 * least_correction;
/// Corrections are carried on to this share of the tolerance.
constexpr double unfinished = 0.01;
/// The unit of lengths is no smaller than this share of the largest path so far.
constexpr double least_extent = 0.3;
/// The action is held against its derivatives at one point of so many.
constexpr int unchecked = 8;

/// Where steps fail and elements differ in length by more than this, the path comes near a singularity.
constexpr double singular_grading = 100;
double grading(const Path& path) {
  const std::span<const double> mesh = path.mesh();
  double shortest = 1, longest = 0;
  for (int k = 0; k < path.elements(); ++k) {
    shortest = std::min(shortest, mesh[k + 1] - mesh[k]);
    longest = std::max(longest, mesh[k + 1] - mesh[k]);
  }
  return longest / shortest;
}

}  // namespace

const char* name(PointKind kind) {
  switch (kind) {
    case PointKind::fold:
      return "fold";
    case PointKind::branch:
      return "branch";
    case PointKind::period_doubling:
      return "period-doubling";
    case PointKind::regular:
      break;
  }
  return "regular";
}

Continuation::Continuation(ProblemFamily family, ContinuationOptions options)
    : family_(std::move(family)), options_(std::move(options)), branch_(family_, path_, w_) {}

Continuation::Continuation(ProblemFamily family, ContinuationOptions options, Seed seed, int side)
    : family_(std::move(family)),
      options_(std::move(options)),
      branch_(family_, path_, w_),
      seed_(std::move(seed)),
      side_(side) {}

bool Continuation::stop(BranchEnd end, std::string message) {
  end_ = end;
  message_ = std::move(message);
  return false;
}

bool Continuation::advance() {
  if (end_ != BranchEnd::none && found_.empty()) return false;
  if (!std::exchange(started_, true) && !begin()) return false;
  if (count_ == options_.points) {
    found_.clear();
    return stop(BranchEnd::points, fmt::format("{} points have been found; ask for more", count_));
  }
  while (found_.empty())
    if (end_ != BranchEnd::none || !step()) return false;
  last_ = std::move(found_.front());
  found_.pop_front();
  ++count_;
  return true;
}

/// Newton's method across the tangent; or to where what varies has the value `landing`. A gradient costs a
/// quarter of what factors do: those there are, while the problem stays what it is, serve as long as they
/// lead to the goal soon.
bool Continuation::correct(double length, const double* landing) {
  const double enough = std::max(unfinished * options_.solve.tolerance, least_goal);
  const double goal = landing ? least_goal : enough;
  double before = INFINITY, way_before = INFINITY, curvature = INFINITY, found = INFINITY;
  bool anew = true, newton = true;  // factors of this path; of that before, where the last move began
  refusal_ = Refusal::rough;
  factors_ = 0;
  for (int k = 0; k < most_corrections; ++k) {
    if (!branch_.linearise(anew ? Branch::Factors::anew : Branch::Factors::before)) {
      if (!branch_.defined()) refusal_ = Refusal::no_problem;
      return false;
    }
    const Move& direction = branch_.direction;
    Move& move = branch_.correction;
    const double along = landing ? branch_.change(true) : branch_.dot(tangent_, direction);
    const double off = landing ? branch_.varied() + branch_.change(false) - *landing
                               : branch_.dot(tangent_, move) + branch_.drift(tangent_);
    if (along == 0) return false;
    move.add(direction, -off / along);
    if (landing) landed_ += branch_.dot(tangent_, move);
    const double way = std::sqrt(branch_.dot(move, move)), size = branch_.largest(move);
    const double rate = k > 0 ? size / before : 1;
    factors_ += anew;
    const bool noise = anew && size < amplified_roundoff && rate > 0.3;
    // Factors of before may hide what those of this path find: it is held against what such found last.
    const double growth = way / (anew ? std::exchange(found, way) : way_before);
    const double fastest = way > small_correction * length ? contraction : slowest;
    if (!noise && (!(way <= longest_correction * length) || growth > fastest)) return false;
    if (!branch_.apply(move, 1)) {
      refusal_ = Refusal::no_problem;
      return false;
    }
    if (k > 0 && newton) curvature = rate / before;
    // What is left after a step of Newton's method, and by how much a step with its factors, which are off by
    // all of the last move and not by half of it, shrinks that.
    const double left = size * (anew ? curvature * size : newton ? 2 * rate : rate);
    const double shrinking = anew ? 2 * curvature * size : left / size;
    if (noise || left <= goal) return true;
    newton = anew;
    anew = !branch_.factored() || (k > 0 && !(left * shrinking * shrinking <= goal));
    before = size;
    way_before = way;
  }
  return before <= enough;
}

void Continuation::Stand::scale(double factor) {
  tangent.scale(factor);
  rate *= factor;
  action_rate *= factor;
  if (factor < 0) orientation = -orientation;
}

/// The next tangent, onward, and what there is to know of the place.
bool Continuation::turn(bool first) {
  if (!branch_.linearise()) {
    refusal_ = branch_.defined() ? Refusal::rough : Refusal::no_problem;
    return false;
  }
  refusal_ = Refusal::rough;
  // A path with nothing left to correct: a long correction is the roundoff of nearly singular factors.
  if (!first && branch_.dot(branch_.correction, branch_.correction) > 1) return false;
  const double length = std::sqrt(branch_.dot(branch_.direction, branch_.direction));
  const double along = first ? 1 : branch_.dot(tangent_, branch_.direction);
  const double onward = std::copysign(1 / length, along);
  cosine_ = first ? 1 : std::abs(along) / (length * std::sqrt(branch_.dot(tangent_, tangent_)));
  here_.path = path_;
  here_.coordinate = branch_.coordinate();
  here_.varied = branch_.varied();
  here_.action = branch_.action();
  here_.tangent = branch_.direction;
  here_.tangent.scale(onward);
  here_.row = branch_.closing_row(here_.tangent);
  here_.rate = onward * branch_.change(true);
  here_.turning = here_.bend = here_.twist = {};
  here_.action_rate = onward * branch_.action_slope();
  here_.energy_time = std::abs(branch_.energy() * path_.duration());
  here_.orientation = branch_.orientation(onward);
  here_.index = branch_.inertia().negative;
  return true;
}

/// Lengths from here on in units of the path that is here, or of a share of the largest before: a path that
/// shrinks to nothing is passed.
void Continuation::measure_anew() {
  const double extent = sizes().q;
  largest_extent_ = std::max(largest_extent_, extent);
  const double unit = std::max(extent, least_extent * largest_extent_);
  here_.units = {unit > 0 ? unit : 1, path_.duration()};
  branch_.set_units(here_.units);
  here_.scale(1 / std::sqrt(branch_.dot(here_.tangent, here_.tangent)));
}

/// So far along the tangent from a place, and back onto the branch, or to where what varies has the value
/// `landing`; on elements that meet the tolerance, or on those of the place. False if that fails.
bool Continuation::go(const Stand& from, double length, bool same_elements, const double* landing) {
  path_ = from.path;
  tangent_ = from.tangent;
  here_.units = from.units;
  branch_.set_units(from.units);
  landed_ = 0;
  refusal_ = Refusal::no_problem;
  if (!branch_.place(from.coordinate)) return false;
  branch_.bind();
  branch_.close_by(from.row);
  if (!branch_.apply(from.ahead(length), 1) || !correct(std::abs(length), landing)) return false;
  for (int k = 0; k < most_resolutions && !same_elements; ++k) {
    const Elements elements = resolve();
    if (elements == Elements::too_many) {
      refusal_ = Refusal::crowded;
      return false;
    }
    if (elements == Elements::fine) break;
    if (!correct(std::abs(length), landing)) return false;
  }
  return turn();
}

/// The same, and onto no other branch that is near.
bool Continuation::stays(const Stand& from, double length, bool same_elements) {
  return go(from, length, same_elements) && cosine_ > sharpest_turn;
}

bool Continuation::give_up(const Stand& from) {
  const double varied = from.varied, graded = grading(from.path);
  if (refusal_ == Refusal::rough && graded > singular_grading) refusal_ = Refusal::crowded;
  switch (refusal_) {
    case Refusal::crowded:
      return stop(
          BranchEnd::collision,
          fmt::format("at {:.8g} the path, whose shortest element is {:.0e} of its longest, needs ever "
                      "more of them: it comes near a singularity; loosen the tolerance",
                      varied, 1 / graded));
    case Refusal::no_problem:
      return stop(BranchEnd::limit,
                  fmt::format("at {:.8g} the branch cannot be followed: beyond, there is no such problem, or "
                              "L is not finite",
                              varied));
    default:
      return stop(
          BranchEnd::too_short,
          fmt::format("at {:.8g} the branch cannot be followed in steps of {:.0e}", varied, least_length));
  }
}

/// The next step that succeeds, with all that is met on it: a shorter one where the value that the branch is
/// to lead to is passed and not found.
bool Continuation::step() {
  std::swap(here_, from_);
  for (;; length_ *= shortening) {
    if (length_ < least_length) return give_up(from_);
    if (stays(from_, length_)) break;
  }
  const double growth = cosine_ > 0.98 ? 2 : cosine_ > 0.95 ? 1.3 : 0.8;
  const double passed = std::exchange(
      length_, std::min(longest_, length_ * (factors_ > many_factors ? std::min(growth, 0.7) : growth)));
  measure_anew();
  curve(from_, passed);
  length_ = std::min(length_, foreseen());
  BranchPoint next = read(PointKind::regular);
  here_.gaps_before = from_.gaps;
  if (++steps_ % unchecked == 0) check_action();
  std::swap(here_, to_);
  const bool met = meet(from_, to_, passed);
  std::swap(here_, met ? to_ : from_);
  if (!met) {
    length_ = shortening * passed;
    refusal_ = Refusal::rough;
    return step();
  }
  if (end_ == BranchEnd::none) found_.push_back({std::move(next)});
  return !found_.empty();
}

}  // namespace extremal
