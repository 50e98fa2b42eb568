#include "solve/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solution/observe.hpp"
#include "solve/finish.hpp"
#include "solve/search.hpp"

namespace extremal {

namespace {

/// Lengths are relative, as Branch::dot measures them.
constexpr double first_length = 0.02, least_length = 1e-7, least_longest = 0.02, most_longest = 0.4;
/// The longest step, so that so many make up the distance wanted where as many points are allowed.
constexpr double coverage = 4;
/// A step is refused where corrections shrink less than this, are longer than this part of it, or where the
/// branch turns by more than the angle with this cosine.
constexpr double contraction = 0.5, longest_correction = 0.5, sharpest_turn = 0.9;
constexpr int most_corrections = 8, most_resolutions = 4;
/// Corrections below this (relative) that shrink no more are roundoff.
constexpr double roundoff = 1e-9, least_goal = 1e-14;
/// Corrections are carried on to this share of the tolerance, elements planned for this one.
constexpr double unfinished = 0.01, spare = 0.1;
constexpr int highest_degree = 16, least_degree = 5, most_elements = 1 << 10;
constexpr double strongest_cut = 16;
/// Elements whose error is below this share of the tolerance are more than needed.
constexpr double lavish = 1e-4;
/// Of the size of the guess: a path smaller than this is at rest.
constexpr double rest = 1e-9;
/// The unit of lengths is no smaller than this share of the largest path so far.
constexpr double least_extent = 0.3;

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
    : family_(std::move(family)), options_(std::move(options)), branch_(family_, w_) {}

bool Continuation::stop(BranchEnd end, std::string message) {
  end_ = end;
  message_ = std::move(message);
  return false;
}

bool Continuation::advance() {
  if (end_ != BranchEnd::none && found_.empty()) return false;
  if (!started_) {
    started_ = true;
    if (!begin()) return false;
  }
  if (count_ == options_.points) {
    found_.clear();
    return stop(BranchEnd::points, fmt::format("{} points have been found; ask for more", count_));
  }
  while (found_.empty())
    if (end_ != BranchEnd::none || !step()) return false;
  point_ = std::move(found_.front());
  found_.pop_front();
  ++count_;
  return true;
}

/// The extremal that a solve finds, with the branch's tangent there.
bool Continuation::begin() {
  w_.levels.bind(family_.problem.lagrangian);
  SolveOptions adaptive = options_.solve;
  adaptive.scheme.reset();
  adaptive.elements = 0;
  const Outcome outcome = Search(family_.problem, adaptive, w_).run();
  if (outcome.status != Status::converged)
    return stop(BranchEnd::not_started, "no extremal to begin with: " + outcome.message);
  for (const double x : family_.problem.guess.q) rest_ = std::max(rest_, rest * std::abs(x));
  const double coordinate = family_.varied == Varied::parameter ? family_.from : w_.path.duration();
  longest_ = std::clamp(coverage / options_.points, least_longest, most_longest);
  length_ = std::min(first_length, longest_);
  if (!branch_.place(coordinate) || resolve() == Elements::too_many || !turn(true))
    return stop(BranchEnd::not_started, "the equations of the branch are singular at its first point");
  if (here_.rate * (family_.to - family_.from) < 0) here_.scale(-1);
  measure_anew();
  first_ = here_;
  found_.push_back(read(PointKind::regular));
  check_action();
  return true;
}

/// Newton's method across the tangent; or to where what varies has the value `landing`.
bool Continuation::correct(double length, const double* landing) {
  const double goal = std::max(unfinished * options_.solve.tolerance, least_goal);
  double before = INFINITY;
  for (corrections_ = 1; corrections_ <= most_corrections && branch_.linearise(); ++corrections_) {
    const Move& direction = branch_.direction;
    Move& move = branch_.correction;
    const double along = landing ? branch_.change(true) : branch_.dot(tangent_, direction);
    const double off = landing ? branch_.varied() + branch_.change(false) - *landing
                               : branch_.dot(tangent_, move) + branch_.drift(tangent_);
    if (along == 0) return false;
    move.add(direction, -off / along);
    const double size = std::sqrt(branch_.dot(move, move));
    const double rate = before < INFINITY ? size / before : 1;
    const bool noise = size < roundoff && rate > 0.3;
    if (!noise && (!(size <= longest_correction * length) || rate > (before < INFINITY ? contraction : 1)))
      return false;
    if (!branch_.apply(move, 1)) return false;
    if (noise || size * rate <= goal) return true;
    before = size;
  }
  return false;
}

Scales Continuation::sizes() const {
  Scales size = scales(w_.path, branch_.tables());
  if (size.q <= rest_) size.q = 0;
  return size;
}

/// Elements that meet the tolerance, and not many more than that takes.
Continuation::Elements Continuation::resolve() {
  const ElementTables& tables = branch_.tables();
  const Scales size = sizes();
  w_.resolution.measure(w_.path, tables);
  const Resolution::Error error = w_.resolution.at(w_.path.degree());
  const double tolerance = options_.solve.tolerance;
  error_ = error.q + 0x1p-53 * size.magnitude * std::sqrt(w_.path.elements() * w_.path.degree());
  branch_.set_null_threshold(std::clamp(3 * error_ / (size.q > 0 ? size.q : 1), 1e-8, 1e-3));
  const double excess = size.q > 0 ? std::max(error.q / size.q, 0.1 * error.v / size.v) / tolerance : 0;
  if (excess <= 1 && (excess == 0 || excess > lavish)) return Elements::fine;
  const auto aim = [&](double share) { return Resolution::Error{share * size.q, 10 * share * size.v}; };
  const Plan plan = w_.planner.plan(w_.resolution, w_.path.mesh(), tables,
                                    {.aim = aim(spare * tolerance),
                                     .tolerated = aim(0.7 * tolerance),
                                     .raised_degree = std::min(w_.path.degree() + 1, highest_degree),
                                     .least_degree = least_degree,
                                     .highest_degree = highest_degree,
                                     .most_elements = most_elements,
                                     .strongest_cut = strongest_cut});
  const bool fewer = plan.degree * plan.mesh.size() < 0.7 * w_.path.degree() * (w_.path.elements() + 1);
  if (excess <= 1 && (plan.mesh.empty() || !fewer)) return Elements::fine;
  if (plan.degree == 0) return Elements::too_many;
  const std::vector<double> before(w_.path.mesh().begin(), w_.path.mesh().end());
  const std::vector<double>& mesh = plan.mesh.empty() ? before : plan.mesh;
  w_.other.resample_from(w_.path, w_.levels.at(plan.degree), mesh);
  if (!tangent_.step.nodes.empty())
    tangent_.step.nodes = interpolated(tangent_.step.nodes, w_.path.coordinates(), before, mesh);
  std::swap(w_.path, w_.other);
  branch_.bind();
  return Elements::changed;
}

void Continuation::Stand::scale(double factor) {
  tangent.scale(factor);
  rate *= factor;
  action_rate *= factor;
  if (factor < 0) orientation = -orientation;
}

/// The next tangent, onward, and what there is to know of the place.
bool Continuation::turn(bool first) {
  if (!branch_.linearise()) return false;
  // A path with nothing left to correct: a long correction is the roundoff of nearly singular factors.
  if (!first && branch_.dot(branch_.correction, branch_.correction) > 1) return false;
  const double length = std::sqrt(branch_.dot(branch_.direction, branch_.direction));
  const double along = first ? 1 : branch_.dot(tangent_, branch_.direction);
  const double onward = std::copysign(1 / length, along);
  cosine_ = first ? 1 : std::abs(along) / (length * std::sqrt(branch_.dot(tangent_, tangent_)));
  here_.path = w_.path;
  here_.coordinate = branch_.coordinate();
  here_.varied = branch_.varied();
  here_.action = branch_.action();
  here_.tangent = branch_.direction;
  here_.tangent.scale(onward);
  here_.rate = onward * branch_.change(true);
  here_.action_rate = onward * branch_.action_slope();
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
  here_.units = {unit > 0 ? unit : 1, w_.path.duration()};
  branch_.set_units(here_.units);
  here_.scale(1 / std::sqrt(branch_.dot(here_.tangent, here_.tangent)));
}

/// So far along the tangent from a place, and back onto the branch. False if that fails.
bool Continuation::go(const Stand& from, double length) {
  w_.path = from.path;
  tangent_ = from.tangent;
  here_.units = from.units;
  branch_.set_units(from.units);
  crowded_ = false;
  if (!branch_.place(from.coordinate)) return false;
  branch_.bind();
  if (!branch_.apply(tangent_, length) || !correct(std::abs(length), nullptr)) return false;
  for (int k = 0; k < most_resolutions; ++k) {
    const Elements elements = resolve();
    crowded_ = elements == Elements::too_many;
    if (crowded_) return false;
    if (elements == Elements::fine) break;
    if (!correct(std::abs(length), nullptr)) return false;
  }
  return turn();
}

/// The next step that succeeds, with all that is met on it.
bool Continuation::step() {
  const Stand from = here_;
  for (;; length_ *= 0.4) {
    if (length_ < least_length)
      return crowded_ ? stop(BranchEnd::collision,
                             fmt::format("at {:.8g} the path needs more than {} elements of degree {}: it "
                                         "comes near a singularity; loosen the tolerance",
                                         from.varied, most_elements, highest_degree))
                      : stop(BranchEnd::limit,
                             fmt::format("at {:.8g} the branch cannot be followed in steps of {:.0e}: it "
                                         "ends, or L is not finite beyond",
                                         from.varied, least_length));
    if (go(from, length_) && cosine_ > sharpest_turn) break;
  }
  const double growth = cosine_ > 0.98 ? 2 : cosine_ > 0.95 ? 1.3 : 0.8;
  const double passed = std::exchange(
      length_, std::min(longest_, length_ * (corrections_ > 4 ? std::min(growth, 0.7) : growth)));
  measure_anew();
  const BranchPoint next = read(PointKind::regular);
  const Stand to = here_;
  check_action();
  meet(from, to, passed);
  here_ = to;
  if (end_ == BranchEnd::none) found_.push_back(next);
  return !found_.empty();
}

BranchPoint Continuation::read(PointKind kind) const {
  BranchPoint point;
  point.parameter = here_.varied;
  point.kind = kind;
  Solution& solution = point.solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.strategy = "continuation";
  solution.trajectory = trajectory_of(here_.path);
  solution.action = here_.action;
  solution.error_estimate = error_;
  solution.morse_index = branch_.inertia().negative;
  solution.nullity = branch_.inertia().zero;
  observe_energy(*branch_.problem().lagrangian, solution);
  return point;
}

}  // namespace extremal
