#include "solve/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solution/observe.hpp"
#include "solve/finish.hpp"
#include "solve/stability.hpp"

namespace extremal {

namespace {

/// Lengths are relative, as Branch::dot measures them.
constexpr double least_length = 1e-7;
/// A step is refused where corrections shrink less than this, are longer than this part of it, or where the
/// branch turns by more than the angle with this cosine.
constexpr double contraction = 0.5, longest_correction = 0.5, sharpest_turn = 0.9;
/// Corrections shorter than this part of a step hardly move the path, but where that is short, as near a
/// singularity: they may grow so much before they shrink.
constexpr double small_correction = 0.05, slowest = 4;
constexpr int most_corrections = 8, most_resolutions = 4;
/// Corrections below this (relative) that shrink no more are roundoff.
constexpr double roundoff = 1e-9, least_goal = 1e-14;
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
    : family_(std::move(family)), options_(std::move(options)), branch_(family_, w_) {}

Continuation::Continuation(ProblemFamily family, ContinuationOptions options, Seed seed, int side)
    : family_(std::move(family)),
      options_(std::move(options)),
      branch_(family_, w_),
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

/// Newton's method across the tangent; or to where what varies has the value `landing`.
bool Continuation::correct(double length, const double* landing) {
  const double goal = std::max(unfinished * options_.solve.tolerance, least_goal);
  double before = INFINITY;
  refusal_ = Refusal::rough;
  for (corrections_ = 1; corrections_ <= most_corrections; ++corrections_) {
    if (!branch_.linearise()) {
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
    const double size = std::sqrt(branch_.dot(move, move));
    const double rate = before < INFINITY ? size / before : 1;
    const bool noise = size < roundoff && rate > 0.3;
    const double fastest = size > small_correction * length ? contraction : slowest;
    if (!noise && (!(size <= longest_correction * length) || (before < INFINITY && rate > fastest)))
      return false;
    if (!branch_.apply(move, 1)) {
      refusal_ = Refusal::no_problem;
      return false;
    }
    // The next one is size²/before² times this one.
    if (noise || size * rate * rate <= goal) return true;
    before = size;
  }
  return false;
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
  here_.path = w_.path;
  here_.coordinate = branch_.coordinate();
  here_.varied = branch_.varied();
  here_.action = branch_.action();
  here_.tangent = branch_.direction;
  here_.tangent.scale(onward);
  here_.row = branch_.closing_row(here_.tangent);
  here_.rate = onward * branch_.change(true);
  here_.action_rate = onward * branch_.action_slope();
  here_.energy_time = std::abs(branch_.energy() * w_.path.duration());
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

/// So far along the tangent from a place, and back onto the branch; on elements that meet the tolerance, or
/// on those of the place. False if that fails.
bool Continuation::go(const Stand& from, double length, bool same_elements) {
  w_.path = from.path;
  tangent_ = from.tangent;
  here_.units = from.units;
  branch_.set_units(from.units);
  refusal_ = Refusal::no_problem;
  if (!branch_.place(from.coordinate)) return false;
  branch_.bind();
  branch_.close_by(from.row);
  if (!branch_.apply(tangent_, length) || !correct(std::abs(length), nullptr)) return false;
  for (int k = 0; k < most_resolutions && !same_elements; ++k) {
    const Elements elements = resolve();
    if (elements == Elements::too_many) {
      refusal_ = Refusal::crowded;
      return false;
    }
    if (elements == Elements::fine) break;
    if (!correct(std::abs(length), nullptr)) return false;
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

/// The next step that succeeds, with all that is met on it.
bool Continuation::step() {
  const Stand from = here_;
  for (;; length_ *= 0.4) {
    if (length_ < least_length) return give_up(from);
    if (stays(from, length_)) break;
  }
  const double growth = cosine_ > 0.98 ? 2 : cosine_ > 0.95 ? 1.3 : 0.8;
  const double passed = std::exchange(
      length_, std::min(longest_, length_ * (corrections_ > 4 ? std::min(growth, 0.7) : growth)));
  measure_anew();
  BranchPoint next = read(PointKind::regular);
  const Stand to = here_;
  if (++steps_ % unchecked == 0) check_action();
  meet(from, to, passed);
  here_ = to;
  if (end_ == BranchEnd::none) found_.push_back({std::move(next)});
  return !found_.empty();
}

BranchPoint Continuation::read(PointKind kind) {
  BranchPoint point;
  point.parameter = here_.varied;
  point.kind = kind;
  const Problem& problem = branch_.problem();
  Solution& solution = point.solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.strategy = "continuation";
  solution.trajectory = trajectory_of(here_.path);
  solution.degree = here_.path.degree();
  solution.action = here_.action;
  solution.error_estimate = error_;
  solution.morse_index = branch_.inertia().negative;
  solution.nullity = branch_.inertia().zero;
  observe_energy(*problem.lagrangian, solution);
  read_momenta(solution);
  if (!problem.periodic) return point;
  if (problem.coordinates() <= most_coordinates_for_multipliers)
    variation_.assemble(problem.lagrangian, solution.trajectory, condensed());
  read_stability(problem, variation_, sizes().q, solution, false);
  here_.doubling = solution.floquet ? doubling_product(*solution.floquet) : 1;
  return point;
}

/// p = ∂L/∂q' of the trajectory against the derivatives of the action.
void Continuation::read_momenta(Solution& solution) {
  const std::size_t n = solution.trajectory.coordinates;
  const std::span<const double> momenta = branch_.momenta();
  solution.momentum_start.assign(momenta.begin(), momenta.begin() + n);
  solution.momentum_end.assign(momenta.begin() + n, momenta.end());
  const Trajectory& trajectory = solution.trajectory;
  // ∫p·q' dt by the range of q: momenta are small at both ends of a swing between points of rest.
  const double swept = std::abs(solution.action + solution.energy.value_or(0) * solution.duration());
  const double range = sizes().range;
  double worst = 0, largest = range > 0 ? swept / range : 0;
  for (const bool end : {false, true}) {
    const double t = end ? solution.duration() : 0;
    const std::size_t first = end ? trajectory.nodes.size() - n : 0;
    const PointValues at =
        evaluate_at(*branch_.problem().lagrangian, {trajectory.nodes.data() + first, n},
                    {trajectory.slopes.data() + first, n}, t, Order::gradient, momentum_memory_);
    const std::vector<double>& action = end ? solution.momentum_end : solution.momentum_start;
    for (std::size_t a = 0; a < n; ++a) {
      worst = std::max(worst, std::abs(at.dv[a] - action[a]));
      largest = std::max(largest, std::abs(action[a]));
    }
  }
  if (largest > 0) worst_momentum_ = std::max(worst_momentum_, worst / largest);
}

}  // namespace extremal
