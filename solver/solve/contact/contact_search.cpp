#include "solve/contact/contact_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/point_range.hpp"
#include "solution/guessed_by.hpp"
#include "solution/path_contacts.hpp"
#include "solve/contact/aside.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/coarse_minimum.hpp"
#include "solve/contact/found_values.hpp"
#include "solve/contact/incompatible.hpp"
#include "solve/contact/intervals.hpp"
#include "solve/contact/joined_path.hpp"
#include "solve/contact/limits.hpp"
#include "solve/contact/shifted_minimum.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// Nodes of a path as points at their times.
Guess guess_of_nodes(const std::vector<double>& times, const std::vector<double>& z) {
  Guess guess;
  for (const double t : times) guess.tau.push_back(t / times.back());
  guess.q = z;
  return guess;
}

/// q(t) of a path of arcs.
void point_of(const Junctions& path, double t, std::span<double> q) {
  std::size_t i = 0;
  while (i + 1 < path.arcs().size() && t >= path.arcs()[i].to) ++i;
  const Trajectory& trajectory = path.solved()[i].trajectory;
  std::vector<double> v(q.size());
  trajectory.at(std::clamp(t - path.arcs()[i].from, 0.0, trajectory.duration()), q, v);
}

/// A touch whose impulse is negative; −1: there is none.
int pulled_touch(const Junctions& path) {
  for (std::size_t j = 0; j < path.touched().size(); ++j)
    if (path.touched()[j] >= 0 && path.impulse(static_cast<int>(j)) < 0) return static_cast<int>(j);
  return -1;
}

/// Free times of waypoints become those of a path.
void put_waypoint_times(const Junctions& path, Problem& problem) {
  if (!problem.extension || problem.extension->waypoints.empty()) return;
  Extension extension = *problem.extension;
  auto next = extension.waypoints.begin();
  for (const SolvedArc& arc : path.solved())
    for (const WaypointImpulse& found : arc.waypoints) {
      if (next->free) next->time = found.time / path.duration();
      ++next;
    }
  problem.extension = std::make_shared<const Extension>(std::move(extension));
}

/// Which end that is fixed does not keep an inequality, as unknowns make it, by more than a coarse path may
/// be wrong; empty: none.
std::string broken_end(const Problem& problem, double size) {
  constexpr double part = 1e-3;
  if (unknowns_of(problem).empty()) return {};
  const std::size_t n = problem.coordinates();
  for (const bool at_end : {false, true}) {
    if (!problem.ends.fixes(at_end)) continue;
    const ConstraintValues values = problem.inequalities->all->at(
        {problem.ends.offset.data() + (at_end ? n : 0), n}, at_end ? problem.duration.value : 0);
    for (Eigen::Index k = 0; k < values.g.size(); ++k)
      if (values.g[k] < -part * size * values.slopes.row(k).norm())
        return fmt::format(
            "the {0} does not keep the inequality '{1}' with the unknowns that satisfy 'where': it is missed "
            "by {2:.3g} there; give another {0}, or other conditions",
            at_end ? "end" : "start", problem.inequalities->texts[static_cast<std::size_t>(k)], -values.g[k]);
  }
  return {};
}

/// Which of these a point that is given lies on; −1: none.
int touched_by(const Problem& problem, const WaypointCondition& waypoint, const std::vector<int>& constraints,
               double t, double size) {
  std::vector<double> q;
  for (const auto& [a, x] : waypoint.fixed) q.push_back(x);
  const ConstraintValues values = problem.inequalities->all->at(q, t);
  const auto found = std::ranges::find_if(constraints, [&](int c) { return on_surface(values, c, size); });
  return found != constraints.end() ? *found : -1;
}

/// A waypoint on a surface at which arcs cannot pass it; empty: there is none. Coordinates that it leaves
/// free would be pushed off the surface by its impulse. Where a contact begins, the arc beside a free time
/// vanishes.
std::string blocked_waypoint(const Problem& problem, const std::vector<Interval>& intervals, double element,
                             double size) {
  if (!problem.extension) return {};
  for (const WaypointCondition& waypoint : problem.extension->waypoints) {
    const double t = waypoint.at(problem.duration.value);
    const bool whole = std::ssize(waypoint.fixed) == problem.coordinates();
    for (const Interval& interval : intervals) {
      if (interval.held.empty() || t < interval.from - element || t > interval.to + element) continue;
      const bool within = t > interval.from && t < interval.to;
      const auto text = [&](int constraint) -> const std::string& {
        return problem.inequalities->texts[static_cast<std::size_t>(constraint)];
      };
      if (within && !whole)
        return fmt::format(
            "the waypoint at t = {:.6g} lies within a contact with '{}' and leaves coordinates "
            "free; fix all of them there",
            t, text(interval.held.front()));
      if (within || !whole || !waypoint.free) continue;
      if (const int constraint = touched_by(problem, waypoint, interval.held, t, size); constraint >= 0)
        return fmt::format(
            "a contact with '{}' begins or ends at the waypoint at t = {:.6g}, whose time is "
            "free; give its time as a number",
            text(constraint), t);
    }
  }
  return {};
}

/// Adds the stretch about what happens in few elements between two times.
void add_if_few(const CoarseAction& action, double from, double to, std::vector<Stretch>& few) {
  if (action.elements_in(from, to) > few_elements || !(to > from)) return;
  const double duration = action.times().back(), middle = (from + to) / 2, half = wider * (to - from) / 2;
  few.push_back({std::max(0.0, middle - half) / duration, std::min(duration, middle + half) / duration});
}

}  // namespace

ContactSearch::ContactSearch(const Problem& problem, const SolveOptions& options, const ArcSolve& solve,
                             bool several)
    : problem_(problem),
      options_(options),
      solve_(solve),
      arcs_(problem_, options, solve),
      several_(several) {}

Solution ContactSearch::run(std::vector<double> z) {
  CoarseElements elements{coarse_elements[0]};
  guess_ = guess_of_nodes(coarse_times(problem_, elements), z);
  for (std::size_t level = 0, closer = 0;
       level < std::size(coarse_elements) && !options_.deadline.passed();) {
    elements.equal = coarse_elements[level];
    if (level > 0 && elements.equal * problem_.coordinates() > most_unknowns) break;
    ++attempts_;
    Attempt attempt = from_elements(elements);
    if (attempt.solution) return *std::move(attempt.solution);
    if (attempt.final) break;
    // Where something happens in few elements there will be more.
    const std::vector<Stretch>& few = attempt.few;
    elements.closer.insert(elements.closer.end(), few.begin(), few.end());
    if (few.empty() || ++closer > most_closer) ++level;
  }
  if (options_.deadline.passed()) {
    failure_.status = Status::iteration_limit;
    failure_.message = fmt::format("stopped after {}; {}", options_.deadline.budget_text(), failure_.message);
  }
  failure_.iterations = arcs_.iterations();
  return std::move(failure_);
}

/// A minimiser by way of the coarse minimum of these elements.
ContactSearch::Attempt ContactSearch::from_elements(const CoarseElements& elements) {
  CoarseMinimum minimum = coarse_minimum(problem_, elements, first_nodes(elements), options_.deadline);
  const MinimumReport& report = minimum.report;
  const std::string& reason = minimum.reason;
  if (!report.converged) {
    if (const std::string contradiction = incompatible_inequalities(problem_, guess_);
        !contradiction.empty()) {
      refuse(Status::no_solution_near, contradiction);
      return {.final = true};
    }
    refuse(report.unbounded || !reason.empty() ? Status::no_solution_near : Status::not_converged,
           !reason.empty() ? reason + "; give another value, or another guess"
           : report.unbounded
               ? "no local minimiser is near: the action has no lower bound along paths that begin at "
                 "the guess. A free path that is longer than a window is no minimiser; shorten the "
                 "duration, or give inequalities that bound the path"
               : fmt::format("no local minimiser was found near the guess: the interior point method did not "
                             "converge. If the path is longer than a window and free of contact, there is "
                             "none; shorten the duration, or give another guess{}",
                             problem_.duration.free ? " or another guess.duration" : ""));
    no_duration_ = !reason.empty();
    return {.final = no_duration_ || report.unbounded};
  }
  guess_ = guess_of_nodes(minimum.times, minimum.z);
  const double size = largest_range(minimum.z, problem_.coordinates());
  if (const std::string broken = broken_end(problem_, size); !broken.empty()) {
    refuse(Status::no_solution_near, broken);
    return {.final = true};
  }
  const double element = minimum.times.back() / elements.equal;
  const CoarseAction action(problem_, minimum.times);
  std::vector<Interval> intervals = coarse_intervals(std::move(minimum));
  if (const std::string blocked = blocked_waypoint(problem_, intervals, element, size); !blocked.empty()) {
    refuse(Status::not_converged, blocked);
    return {.final = true};
  }
  Attempt attempt;
  for (const Interval& interval : intervals)
    if (!interval.held.empty()) add_if_few(action, interval.from, interval.to, attempt.few);
  Joined joined = join(std::move(intervals));
  attempt.solution = std::move(joined.solution);
  attempt.final = saddle_;
  if (joined.missed && joined.missed->forbidden)
    add_if_few(action, joined.missed->from, joined.missed->to, attempt.few);
  return attempt;
}

/// Nodes between those of the path found last, moved aside of what shorter elements show to be forbidden.
std::vector<double> ContactSearch::first_nodes(const CoarseElements& elements) const {
  const CoarseAction action(problem_, elements);
  const std::vector<double>& times = action.times();
  const std::size_t n = problem_.coordinates();
  std::vector<double> z(times.size() * n);
  for (std::size_t k = 0; k < times.size(); ++k) guess_.at(times[k] / times.back(), {z.data() + k * n, n});
  if (!elements.closer.empty()) move_aside(problem_, action, z);
  return z;
}

/// What a coarse minimum holds, and when.
std::vector<Interval> ContactSearch::coarse_intervals(CoarseMinimum minimum) {
  const auto held = [&](const CoarseAction& action) {
    return intervals_of(problem_, action, minimum.z, minimum.report.multipliers);
  };
  const CoarseAction action(problem_, minimum.times);
  constants_ = action.constants(action.integral_multipliers(minimum.report));
  const std::vector<Interval> intervals = held(action);
  if (!shift_in_time(problem_, intervals, minimum)) return intervals;
  guess_ = guess_of_nodes(minimum.times, minimum.z);
  return held(CoarseAction(problem_, minimum.times));
}

/// Arcs of these intervals, which change until the law holds. Nothing where it does not.
ContactSearch::Joined ContactSearch::join(std::vector<Interval> intervals) {
  PathPoints path = [this](double t, std::span<double> q) { guess_.at(t / problem_.duration.value, q); };
  std::optional<Junctions> junctions, before;
  Joined joined;
  for (int k = 0; k < most_changes && !options_.deadline.passed(); ++k) {
    tidy(intervals, problem_.duration.value);
    junctions.emplace(arcs_, intervals, path, constants_);
    const Junctions::Result result = junctions->run();
    if (result == Junctions::Result::failed) {
      refuse(Status::not_converged,
             "no local minimiser was found near the guess: " + junctions->message() + "; give another guess" +
                 (problem_.inequalities->count() > 1 ? ", or fewer inequalities" : ""));
      return joined;
    }
    if (result == Junctions::Result::collapsed) {
      leave_out(intervals, junctions->collapsed(), problem_.duration.value);
      continue;
    }
    if (result == Junctions::Result::simultaneous) {
      intervals = junctions->separated(intervals);
      before.emplace(*std::move(junctions));
      path = [&before](double t, std::span<double> q) { point_of(*before, t, q); };
      continue;
    }
    if (take_away_touch(*junctions, intervals)) continue;
    if (problem_.duration.free) problem_.duration.value = junctions->duration();
    put_waypoint_times(*junctions, problem_);
    const std::vector<double>& constants = junctions->constants();
    put_unknowns({constants.begin(), constants.begin() + std::ssize(unknowns_of(problem_))}, problem_);
    const std::optional<Violation> violation = worst_violation(arcs_, *junctions);
    if (!violation) return {accept(*junctions)};
    joined.missed = violation;
    refuse(Status::not_converged, describe(*violation));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      intervals[i].from = junctions->arcs()[i].from;
      intervals[i].to = junctions->arcs()[i].to;
    }
    before.emplace(*std::move(junctions));
    constants_ = before->constants();
    path = [&before](double t, std::span<double> q) { point_of(*before, t, q); };
    const double middle = (violation->from + violation->to) / 2;
    const double half = (violation->to - violation->from) / 2 * (violation->forbidden ? 1 : freed_stretch);
    change(intervals, violation->constraint, violation->forbidden, middle - half, middle + half,
           problem_.duration.value);
  }
  return joined;
}

/// Takes away a touch whose impulse pulls, and shortens a contact that pulls a free end.
bool ContactSearch::take_away_touch(const Junctions& path, std::vector<Interval>& intervals) const {
  if (const int pulling = pulled_touch(path); pulling >= 0) {
    intervals[pulling + 1].touched = -1;
    return true;
  }
  const std::vector<EndContact>& contacts = path.end_contacts();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].holonomic || path.end_impulse(c) >= -negative_force * path.momentum()) continue;
    const int k = contacts[c].constraint;
    Interval& end = contacts[c].at_end ? intervals.back() : intervals.front();
    std::vector<int>& touched = contacts[c].at_end ? end.at_end : end.at_start;
    if (std::erase(touched, k) > 0) return true;
    const double part = (end.to - end.from) / 4, duration = problem_.duration.value;
    if (contacts[c].at_end)
      change(intervals, k, false, end.to - part, end.to, duration);
    else
      change(intervals, k, false, end.from, end.from + part, duration);
    return true;
  }
  return false;
}

std::string ContactSearch::describe(const Violation& violation) const {
  const std::string& text = problem_.inequalities->texts[violation.constraint];
  const double t = (violation.from + violation.to) / 2;
  return violation.forbidden
             ? fmt::format("the path found does not keep '{}' near t = {:.6g}, by {:.1e}; give another guess",
                           text, t, violation.amount)
             : fmt::format("the path found is pulled by '{}' near t = {:.6g}; give another guess", text, t);
}

std::optional<Solution> ContactSearch::accept(Junctions& path) {
  const bool untouched = std::ranges::all_of(path.end_contacts(), &EndContact::holonomic);
  if (path.arcs().size() == 1 && path.arcs().front().held.empty() && untouched) return accept_free(path);
  if (!is_minimum(arcs_, path)) {
    saddle_ = true;
    refuse(Status::no_solution_near,
           "no local minimiser is near: the path found is stationary, but other paths beside it that keep "
           "the inequalities have less action; give another guess, or shorten the duration");
    return std::nullopt;
  }
  Solution solution = joined_path(arcs_, path);
  singular_ = several_ && path.singular();
  if (solution.error_estimate <= options_.tolerance * path.size()) return solution;
  refuse(Status::not_converged,
         fmt::format("the error of the path is {:.1e}, more than the tolerance allows; times at which "
                     "contacts begin amplify roundoff. Give a larger tolerance",
                     solution.error_estimate));
  return std::nullopt;
}

/// An extremal that no inequality touches, by itself.
std::optional<Solution> ContactSearch::accept_free(const Junctions& path) {
  Problem free = problem_;
  free.inequalities = nullptr;
  free.guess = guess_of(path.solved().front().trajectory);
  Solution solution = solve_(free, options_);
  solution.iterations += arcs_.iterations();
  auto contacts = std::make_shared<PathContacts>();
  contacts->constraints = problem_.inequalities->count();
  contacts->arcs.push_back(
      {0, solution.converged() ? solution.duration() : problem_.duration.value, {}, nullptr});
  solution.contacts = std::move(contacts);
  if (!solution.converged()) {
    failure_ = std::move(solution);
    return std::nullopt;
  }
  if (solution.morse_index ? *solution.morse_index == 0 : is_minimum(arcs_, path)) {
    solution.message += "; no contact";
    return solution;
  }
  saddle_ = true;
  std::string window;
  if (!solution.windows.empty())
    window = fmt::format(", whose first ends at t = {:.6g}", solution.windows.front()[1]);
  refuse(Status::no_solution_near,
         fmt::format("no local minimiser is near: the extremal found is free of contact and longer than a "
                     "window{}, so it does not minimise the action; shorten the duration, or give "
                     "inequalities that bound the path",
                     window));
  return std::nullopt;
}

void ContactSearch::refuse(Status status, std::string message) {
  failure_ = {};
  failure_.status = status;
  failure_.message = std::move(message);
}

}  // namespace extremal
