#include "solve/branch/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "problem/point_range.hpp"
#include "solve/accept/acceptance.hpp"
#include "solve/branch/approached.hpp"
#include "solve/branch/common_symmetries.hpp"
#include "solve/branch/half_period.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/root.hpp"
#include "solve/search/search.hpp"

namespace extremal {

using namespace limits::continuation;

namespace {

double growth(const Tracker& tracker) {
  const double cosine = tracker.cosine();
  const double growth = cosine > straight ? growth_if_straight : cosine > bent ? growth_if_bent : growth_else;
  return tracker.factorisations() > many_factorisations ? std::min(growth, growth_if_many) : growth;
}

/// The action a little onward and back against the integral of its derivative, by Simpson's rule; nearer by
/// where that is not exact enough. Infinite where neither is known.
double action_difference(Tracker& tracker) {
  if (tracker.branch().problem().paired) return INFINITY;  // the action of two copies is zero
  const BranchState at = tracker.state;
  // −E T alone may be large: S vanishes for small swings.
  const double size = std::max({std::abs(at.action), std::abs(at.action_rate), at.energy_time});
  const Branch& branch = tracker.branch();
  double least = INFINITY;
  for (const double by : probes) {
    double action[2], rate[2];
    bool there = size > 0;
    for (int side = 0; side < 2 && there; ++side) {
      there = tracker.reach(at, side ? by : -by, true);
      const BranchState& here = tracker.state;
      action[side] = here.action;
      rate[side] = here.action_rate * branch.dot(tracker.tangent(), tracker.tangent()) /
                   branch.dot(tracker.tangent(), here.tangent);
    }
    if (!there) continue;
    const double found = (action[1] - action[0]) / (2 * by);
    const double expected = (rate[0] + 4 * at.action_rate + rate[1]) / 6;
    least = std::min(least, std::abs(found - expected) / size);
    if (least < exact) break;
  }
  tracker.state = at;
  return least;
}

/// Along rest the energy closes no equations: it is the same for all durations.
bool rests(const Path& path) {
  double size = 0;
  for (const double x : path.nodes()) size = std::max(size, std::abs(x));
  return largest_range(path.nodes(), path.coordinates()) <= rest * size;
}

/// Whether members of a family beside its first can be shifted in time, where there are any.
bool shifts_in_time_beside(const ProblemFamily& family) {
  const std::optional<Problem> beside = family.at(family.from + beside_first * (family.to - family.from));
  return !beside || beside->shifts_in_time();
}

/// Nothing where the period is given.
Continuation::PeriodGrowth period_of(const ProblemFamily& family, const BranchState& state) {
  if (family.varied == Varied::duration || !family.problem.periodic || !family.problem.duration.free)
    return {};
  const double duration =
      family.varied == Varied::energy ? state.tangent.parameter : state.tangent.step.duration;
  return {state.path.duration(), state.varied, state.rate / duration, state.varied_error,
          share_at_rest(state.path)};
}

/// The value of the number that varies at which the period diverges. Next to a homoclinic or heteroclinic
/// orbit the number approaches it as e^{−λT}: g = ∂varied/∂T falls as e^{−λT}, and g/λ is the rest of the
/// way. Nothing unless that is less than `error`.
struct PeriodLimit {
  double varied = 0, rate = 0;  ///< the limit, and λ
};
std::optional<PeriodLimit> limit_of_period(const Continuation::PeriodGrowth& before,
                                           const Continuation::PeriodGrowth& here, double error) {
  const double longer = here.duration - before.duration;
  const double decay = std::log(before.slope / here.slope) / longer, rest = here.slope / decay;
  if (!(longer > 0 && decay * here.duration > lasting && here.at_rest > mostly)) return std::nullopt;
  if (!(std::abs(rest) <= error)) return std::nullopt;
  return PeriodLimit{here.varied + rest, decay};
}

}  // namespace

Continuation::Continuation(ProblemFamily family, ContinuationOptions options)
    : family_(with_common_symmetries(std::move(family))),
      options_(std::move(options)),
      tracker_(family_, options_.solve.tolerance) {}

Continuation::Continuation(ProblemFamily family, ContinuationOptions options, FirstState first)
    : family_(with_common_symmetries(std::move(family))),
      options_(std::move(options)),
      tracker_(family_, options_.solve.tolerance),
      start_(std::move(first)) {}

bool Continuation::stop(BranchEnd end, std::string message) {
  end_ = end;
  message_ = std::move(message);
  if (unknown_indices_ > 0)
    message_ +=
        fmt::format("; at {} points the Morse index is not known: no bifurcation was found that changes it",
                    unknown_indices_);
  if (hidden_points_ > 0)
    message_ += fmt::format(
        "; at {} points roundoff hides the extremal by more than the tolerance: loosen it", hidden_points_);
  return false;
}

void Continuation::add(FoundPoint found) {
  worst_momentum_ = std::max(worst_momentum_, found.point.momentum_difference);
  found_.push_back(std::move(found));
}

bool Continuation::advance() {
  if (end_ != BranchEnd::none && found_.empty()) return false;
  if (!std::exchange(started_, true) && !begin() && found_.empty()) return false;
  if (count_ == options_.points) {
    found_.clear();
    return stop(BranchEnd::points, fmt::format("{} points have been found; {}", count_, onward()));
  }
  while (found_.empty())
    if (end_ != BranchEnd::none || !step()) return false;
  last_ = std::move(found_.front());
  found_.pop_front();
  ++count_;
  if (last_.point.kind == PointKind::fold) turned_at_ = last_.point.parameter;
  return true;
}

/// What to do where points are spent.
std::string Continuation::onward() const {
  const double left = std::abs(family_.to - last_.point.parameter);
  if (!turned_at_ || left <= std::abs(family_.to - *turned_at_)) return "ask for more";
  return fmt::format(
      "the branch has turned at {:.10g} and leads away from {:.10g}; ask for more points, if it may turn "
      "again",
      *turned_at_, family_.to);
}

bool Continuation::begin() {
  longest_ = std::clamp(coverage / options_.points, least_longest, most_longest);
  length_ = std::min(first_length, longest_);
  if (!(start_ ? begin_from_state() : begin_from_solve())) return false;
  tracker_.measure_anew();
  FoundPoint point{read_point(tracker_, PointKind::regular)};
  add(first_point_ ? *std::exchange(first_point_, std::nullopt) : std::move(point));
  first_ = tracker_.state;
  index_ = first_.index;
  check_action();
  return true;
}

/// The extremal that a solve finds, with the branch's tangent there.
bool Continuation::begin_from_solve() {
  tracker_.workspace().levels.bind(family_.problem.lagrangian);
  const SolveOptions adaptive = options_.solve.adaptive();
  Acceptance acceptance(family_.problem, adaptive, tracker_.workspace());
  Search search(family_.problem, adaptive, tracker_.workspace());
  const Outcome& outcome = search.run(&acceptance);
  if (const Solution first = acceptance.result(outcome); !first.converged())
    return stop(BranchEnd::not_started, "no extremal to begin with: " + first.message);
  if (family_.varied == Varied::duration && rests(outcome.path)) return end_at_first();
  double at_rest = 0;
  for (const double x : family_.problem.guess.q) at_rest = std::max(at_rest, rest * std::abs(x));
  const bool by_parameter = family_.varied == Varied::parameter;
  const double coordinate = by_parameter ? family_.from : outcome.path.duration();
  const std::optional<Problem> first = by_parameter ? family_.at(coordinate) : std::nullopt;
  const bool alone = first && (first->symmetries.size() < family_.problem.symmetries.size() ||
                               (first->shifts_in_time() && !shifts_in_time_beside(family_)));
  const auto begin = [&] { return !alone && tracker_.begin(search.path(), coordinate, at_rest); };
  const bool begins =
      begin() && (begin_across_family(at_rest) || !by_parameter || tracker_.branch().regular());
  if (!begins) {
    const bool beside = begin_beside(search.path(), at_rest) && (alone || tracker_.branch().regular());
    if (!beside && !begin()) return end_at_first();
    if (!beside) first_point_.reset();
  }
  BranchState& state = tracker_.state;
  if (state.rate * (family_.to - family_.from) < 0) state.scale(-1);
  return true;
}

/// The first member alone may have symmetries, or other directions, along which its extremals are a family.
/// Its point is found with these held, and the branch begins beside it: on a branch that leads on from it the
/// extremal half as far beside is about half as far away. Directions that are null at the first member are
/// soft beside it, and enlarge roundoff the more the nearer, so that extremals are sought ever farther. It
/// begins so far beside that symmetries alone leave null directions: eigenvalues that are zero at the first
/// member tell the index there.
bool Continuation::begin_beside(const Path& path, double at_rest) {
  if (family_.varied != Varied::parameter) return false;
  const ProblemFamily alone = with_symmetries_of_first(family_);
  Tracker first(alone, options_.solve.tolerance);
  if (!first.begin(path, family_.from, at_rest)) return false;
  first.measure_anew();
  first_point_ = FoundPoint{read_point(first, PointKind::regular)};
  const auto beside = [&](double part) {
    const double value = family_.from + part * (family_.to - family_.from);
    return tracker_.begin_beside(first.state, value, at_rest);
  };
  const std::optional<double> near = beside(beside_first / 2), far = beside(beside_first);
  if (!near || !far || *near > half_as_far * *far) return false;
  for (double part = beside_first; part <= first_length; part *= 2)
    if (beside(part) && tracker_.state.nullity <= tracker_.branch().phases()) return true;
  return beside(beside_first / 2).has_value();
}

/// Whether the extremals with one value are a family, which the branch goes across. Then they are one beside
/// the first as well, and the equations hold along its directions.
bool Continuation::begin_across_family(double at_rest) {
  tracker_.measure_anew();
  const BranchState alone = tracker_.state;
  if (tracker_.hold_family()) {
    const BranchState first = tracker_.state;
    const auto goes_on = [&](double length) {
      return tracker_.reach(first, length) && tracker_.balanced() && tracker_.hold_family() &&
             tracker_.state.family.size() == first.family.size();
    };
    if (goes_on(first_length) || goes_on(-first_length)) return tracker_.begin(first, at_rest);
  }
  tracker_.let_family_go(alone, at_rest);
  return false;
}

bool Continuation::end_at_first() {
  singular_at_first_ = !first_point_;
  if (singular_at_first_)
    return stop(BranchEnd::not_started, "the equations of the branch are singular at its first point");
  add(*std::exchange(first_point_, std::nullopt));
  return stop(
      BranchEnd::too_short,
      fmt::format("at {:.8g} the branch cannot be followed: the extremal is one of a family, of which none "
                  "with another value was found beside it",
                  family_.from));
}

bool Continuation::begin_from_state() {
  const auto [first, regular] = *std::exchange(start_, std::nullopt);
  if (regular) tracker_.branch().set_regular();
  return tracker_.begin(first, rest * first.units.extent) ||
         stop(BranchEnd::not_started, "the equations of the branch are singular at its first point");
}

/// The next step that succeeds, with all that is found on it: a shorter one where the value that the branch
/// is to lead to is passed and not found.
bool Continuation::step() {
  BranchState& state = tracker_.state;
  tracker_.begin_off_kinks();
  std::swap(state, from_);
  bool tried_over = false;
  while (!lands()) {
    if (tracker_.failure() == StepFailure::hidden && !std::exchange(tried_over, true) && step_over()) break;
    length_ *= shortening;
    if (length_ < least_length || options_.solve.deadline.passed()) return give_up(from_);
  }
  if (ends_on_crossing()) end_beside_crossing();
  const bool hidden = state.left > options_.solve.tolerance;
  const double length = std::exchange(length_, std::min(longest_, length_ * growth(tracker_)));
  tracker_.measure_anew();
  if (!from_.family.empty()) tracker_.hold_family_anew();
  tracker_.predict(from_, length);
  length_ = std::min(length_, tracker_.predictable_length());
  BranchPoint next = read_point(tracker_, PointKind::regular);
  // Quadratures agree on a path whose forces they all overlook.
  if (!next.resolved) return retry(length);
  if (++steps_ % unchecked == 0) check_action();
  std::swap(state, to_);
  StepEvents events =
      locate_events(tracker_, {family_, first_, options_.other_branches}, {from_, to_, length});
  if (!events.missed) count_index(events, next);
  std::swap(state, to_);
  // An eigenvalue that seems to pass zero where no branch crosses: a leap onto another branch.
  if (events.missed || (!events.index_known && length > shortest_leap)) return retry(length);
  end_at_half_period(length, events);
  for (FoundPoint& found : events.points) add(std::move(found));
  if (events.end != BranchEnd::none) {
    stop(events.end, std::move(events.message));
  } else {
    add({std::move(next)});
    hidden_points_ += hidden;
  }
  before_ = std::exchange(here_, period_of(family_, state));
  if (end_ == BranchEnd::none) end_where_period_diverges(here_.error, state);
  return !found_.empty();
}

/// Whether the step from the last state leads along the branch.
bool Continuation::lands() {
  return tracker_.reach_smoothly(from_, length_) && tracker_.turns_one_way(from_) && !halves_period();
}

/// Where equations are so nearly singular that roundoff hides where a step ends, shorter ones end no better,
/// and a longer one may lead over it. Whether branches cross there nothing can tell: only where the index is
/// as before, none need to.
bool Continuation::step_over() {
  const double shorter = length_;
  const auto same_index = [&](const BranchState& a, const BranchState& b) {
    return a.index == b.index && a.nullity == b.nullity;
  };
  while ((length_ *= lengthening) <= longest_ && !options_.solve.deadline.passed())
    if (lands() && same_index(tracker_.state, from_)) return true;
  length_ = shorter;
  tracker_.fail(StepFailure::hidden);
  return false;
}

/// Whether the last step did: roundoff decides the sign of the crossing, or more directions are open.
bool Continuation::ends_on_crossing() const {
  const BranchState& state = tracker_.state;
  return state.open > from_.open || std::abs(state.crossing) < on_crossing * std::abs(from_.crossing);
}

/// A step that ends where branches cross tells neither side: a shorter one, unless that does, too.
void Continuation::end_beside_crossing() {
  const double shorter = shortening * length_;
  if (tracker_.reach_smoothly(from_, shorter) && !ends_on_crossing())
    length_ = shorter;
  else
    tracker_.reach_smoothly(from_, length_);
}

/// A shorter step than that to the tracker's state.
bool Continuation::retry(double length) {
  std::swap(tracker_.state, from_);
  length_ = shortening * length;
  tracker_.fail(StepFailure::rough);
  return step();
}

/// Orbits that differ by less from themselves half a period later have half the period. Where the equations
/// are nearly singular the error is overestimated.
double Continuation::half_distance() const {
  const double extent = from_.units.extent;
  return std::clamp(half_period_errors * tracker_.error(), half_period * extent, nearly_half_period * extent);
}

/// Whether the last step led from an orbit onto one of half the period: these are another branch.
bool Continuation::halves_period() {
  const auto has_half = [&](const BranchState& state) {
    return has_half_period(family_, state.varied, trajectory_of(state.path), half_distance());
  };
  return has_half(tracker_.state) && !has_half(from_);
}

/// Where orbits meet those of half their period, run through twice, beyond are the same ones half a period
/// later: what is left of them less themselves half a period later passes zero there. The point may be found
/// a little beyond the step.
void Continuation::end_at_half_period(double length, StepEvents& events) {
  const Trajectory from = trajectory_of(from_.path), to = trajectory_of(tracker_.state.path);
  const double before = alternation(family_, from_.varied, from, from).value_or(0);
  if (before <= std::pow(half_distance(), 2)) return;
  const bool passes = *alternation(family_, from_.varied, from, to) < 0;
  const double most = nearly_half_period * std::sqrt(before);
  const auto met = std::ranges::find_if(events.points, [&](const FoundPoint& found) {
    const BranchPoint& point = found.point;
    if (point.kind == PointKind::branch && passes) return true;
    return (point.kind == PointKind::branch || point.kind == PointKind::fold) &&
           has_half_period(family_, point.parameter, point.solution.trajectory, most);
  });
  if (met != events.points.end()) {
    events.points.erase(met + 1, events.points.end());
  } else if (!passes || events.end != BranchEnd::none || !reach_half_period(length, before)) {
    return;
  } else {
    events.points = {{read_point(tracker_, PointKind::regular)}};
  }
  events.end = BranchEnd::closed;
  events.message = fmt::format(
      "the branch is closed: at {:.8g} its orbit repeats one of half the period, and beyond are the "
      "same ones half a period later",
      events.points.back().point.parameter);
}

/// To where the orbit repeats one of half the period, on a step of this length on which neither a fold nor a
/// branch is known to be. Roundoff may hide where the number turns back; what alternates falls there as a
/// line does. `before`: the alternation of the first orbit. The tracker is where it was if none is found.
bool Continuation::reach_half_period(double length, double before) {
  const BranchState to = tracker_.state;
  const Trajectory first = trajectory_of(from_.path);
  const auto left = [&] {
    const BranchState& state = tracker_.state;
    return *alternation(family_, state.varied, first, trajectory_of(state.path));
  };
  const double at = root(tracker_, from_, {0, before}, {length, left()}, std::nullopt, left,
                         [&](double, double change) { return is_located(tracker_, family_, change); });
  if (std::isfinite(at) &&
      has_half_period(family_, tracker_.state.varied, trajectory_of(tracker_.state.path), half_distance()))
    return true;
  tracker_.state = to;
  return false;
}

/// Along a step the index changes by the eigenvalues that pass zero, which are counted on one mesh. Where the
/// number at its end differs from their sum, elements are too long for the fields that decide it, and it is
/// known where it was counted on shorter pieces.
void Continuation::count_index(StepEvents& events, BranchPoint& next) {
  const auto forget = [](BranchPoint& point) {
    point.solution.morse_index = point.solution.nullity = std::nullopt;
  };
  const bool known = events.index_known && from_.index == index_;
  if (events.index_known) index_ += events.index_change;
  for (FoundPoint& found : events.points)
    if (!known) forget(found.point);
  if (to_.index_resolved || (events.index_known && to_.index == index_)) return;
  forget(next);
  // With forces and in phase space there is none to know.
  if (!family_.problem.paired && !family_.problem.phase) ++unknown_indices_;
}

std::optional<Problem> Continuation::problem_at(double value) const {
  return family_.varied == Varied::parameter ? family_.at(value) : family_.problem;
}

/// Where the way that is left to the limit is no longer than `error`.
bool Continuation::end_where_period_diverges(double error, const BranchState& last) {
  const std::optional<PeriodLimit> limit = limit_of_period(before_, here_, error);
  if (!limit) return false;
  const std::optional<Problem> problem = problem_at(last.varied);
  if (!problem || !passes_saddle(*problem, last.path, limit->rate)) return false;
  stop(BranchEnd::infinite_period,
       fmt::format("the period diverges at {} {:.8g}: a homoclinic or heteroclinic orbit", family_.name,
                   limit->varied));
  return true;
}

void Continuation::check_action() {
  const double difference = action_difference(tracker_);
  if (difference < INFINITY) worst_action_slope_ = std::max(worst_action_slope_, difference);
}

bool Continuation::give_up(const BranchState& from) {
  if (end_where_period_diverges(hardly * std::abs(family_.to - family_.from), from)) return false;
  const double varied = from.varied;
  if (const Deadline& deadline = options_.solve.deadline; deadline.passed())
    return stop(BranchEnd::budget, fmt::format("at {:.8g} {} (solve.budget) is spent; raise it", varied,
                                               deadline.budget_text()));
  if (const std::optional<Problem> problem = problem_at(varied);
      problem && tracker_.failure() != StepFailure::no_problem && near_singularity(*problem, from.path))
    return stop(BranchEnd::collision,
                fmt::format("at {:.8g} the path, whose shortest element is {:.0e} of its longest, needs ever "
                            "more of them: it comes near a singularity; loosen the tolerance",
                            varied, 1 / grading(from.path)));
  switch (tracker_.failure()) {
    case StepFailure::crowded:
      return stop(BranchEnd::too_short,
                  fmt::format("at {:.8g} no number of elements meets the tolerance; loosen it", varied));
    case StepFailure::no_problem:
      return stop(BranchEnd::limit,
                  fmt::format("at {:.8g} the branch cannot be followed: beyond, there is no such problem, or "
                              "L is not finite",
                              varied));
    case StepFailure::hidden:
      return stop(
          BranchEnd::too_short,
          fmt::format("at {:.8g} roundoff hides the branch: its equations are nearly singular; loosen "
                      "the tolerance",
                      varied));
    default:
      return stop(
          BranchEnd::too_short,
          fmt::format("at {:.8g} the branch cannot be followed in steps of {:.0e}", varied, least_length));
  }
}

}  // namespace extremal
