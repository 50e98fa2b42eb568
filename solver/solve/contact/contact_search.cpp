#include "solve/contact/contact_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "problem/inequalities.hpp"
#include "solution/path_contacts.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/coarse_minimum.hpp"
#include "solve/contact/intervals.hpp"
#include "solve/contact/joined_path.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// Nodes of a path as points at their times.
Guess guess_of_nodes(int elements, const std::vector<double>& z) {
  Guess guess;
  for (int k = 0; k <= elements; ++k) guess.tau.push_back(static_cast<double>(k) / elements);
  guess.q = z;
  return guess;
}

/// Nodes of a path between those of a coarser one.
std::vector<double> finer(const Guess& guess, int n, int elements) {
  std::vector<double> z((elements + 1) * n);
  for (int k = 0; k <= elements; ++k)
    guess.at(static_cast<double>(k) / elements, {z.data() + k * n, static_cast<std::size_t>(n)});
  return z;
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

/// Whether each waypoint lies within an arc.
bool meets_waypoints(const Problem& problem, const Junctions& path) {
  std::size_t met = 0;
  for (const SolvedArc& arc : path.solved()) met += arc.waypoints.size();
  return !problem.extension || met == problem.extension->waypoints.size();
}

/// Whether q(T) = q(0), and any time may be the first one.
bool may_be_shifted(const Problem& problem) {
  if (!problem.periodic || problem.duration.where || problem.extension) return false;
  if (!problem.lagrangian->structure().autonomous || !problem.inequalities->all->autonomous()) return false;
  const int n = problem.coordinates();
  for (const Triplet& z : problem.ends.z)
    if (z.row >= n && (z.value != 1 || problem.ends.home[z.column] != z.row - n)) return false;
  return std::all_of(problem.ends.offset.begin(), problem.ends.offset.end(), [](double c) { return c == 0; });
}

/// The middle of the longest interval.
double middle_of_longest(const std::vector<Interval>& intervals) {
  const auto longest =
      std::ranges::max_element(intervals, {}, [](const Interval& i) { return i.to - i.from; });
  return (longest->from + longest->to) / 2;
}

/// Nodes, or what belongs to them, of a closed path that begins `by` nodes later; `size` values each.
void rotate_nodes(std::vector<double>& values, int by, int elements, std::size_t size) {
  values.resize(elements * size);  // the last node is the first one
  std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(by * size), values.end());
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
  guess_ = guess_of_nodes(coarse_elements[0], z);
  for (const int elements : coarse_elements) {
    if (options_.deadline.passed()) break;
    if (elements * problem_.coordinates() > most_unknowns && elements != coarse_elements[0]) break;
    z = finer(guess_, problem_.coordinates(), elements);
    auto [report, reason] = coarse_minimum(problem_, elements, z, options_.deadline);
    if (!report.converged) {
      refuse(
          report.unbounded || !reason.empty() ? Status::no_solution_near : Status::not_converged,
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
      if (no_duration_) break;
      if (report.unbounded) break;
      continue;
    }
    guess_ = guess_of_nodes(elements, z);
    multipliers_ = CoarseAction(problem_, elements).integral_multipliers(report);
    if (std::optional<Solution> found = join(coarse_intervals(elements, z, std::move(report.multipliers))))
      return *std::move(found);
    if (saddle_) break;
  }
  if (options_.deadline.passed()) {
    failure_.status = Status::iteration_limit;
    failure_.message = fmt::format("stopped after {}; {}", options_.deadline.budget_text(), failure_.message);
  }
  failure_.iterations = arcs_.iterations();
  return std::move(failure_);
}

/// What a coarse minimum holds, and when. A closed path on which a contact begins or ends next to t = 0 is
/// shifted in time.
std::vector<Interval> ContactSearch::coarse_intervals(int elements, std::vector<double> z,
                                                      std::vector<double> multipliers) {
  const CoarseAction action(problem_, elements);
  std::vector<Interval> intervals = intervals_of(problem_, action, z, multipliers);
  if (intervals.size() == 1 || !may_be_shifted(problem_)) return intervals;
  const double duration = problem_.duration.value, near = clear_elements * duration / elements;
  if (intervals.front().held == intervals.back().held && intervals.front().to > near &&
      intervals.back().from < duration - near)
    return intervals;
  const int by = static_cast<int>(std::lround(middle_of_longest(intervals) / duration * elements));
  const auto n = static_cast<std::size_t>(problem_.coordinates());
  rotate_nodes(z, by, elements, n);
  z.insert(z.end(), z.begin(), z.begin() + static_cast<std::ptrdiff_t>(n));
  rotate_nodes(multipliers, by, elements, problem_.inequalities->count());
  guess_ = guess_of_nodes(elements, z);
  return intervals_of(problem_, action, z, multipliers);
}

/// Arcs of these intervals, which change until the law holds. Nothing where it does not.
std::optional<Solution> ContactSearch::join(std::vector<Interval> intervals) {
  PathPoints path = [this](double t, std::span<double> q) { guess_.at(t / problem_.duration.value, q); };
  std::optional<Junctions> junctions, before;
  for (int k = 0; k < most_changes && !options_.deadline.passed(); ++k) {
    tidy(intervals, problem_.duration.value);
    junctions.emplace(arcs_, intervals, path, multipliers_);
    const Junctions::Result result = junctions->run();
    if (result == Junctions::Result::failed) {
      refuse(Status::not_converged, "no local minimiser was found near the guess: " + junctions->message() +
                                        "; give another guess, or fewer inequalities");
      return std::nullopt;
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
    const std::optional<Violation> violation = worst_violation(arcs_, *junctions);
    if (!violation && meets_waypoints(problem_, *junctions)) return accept(*junctions);
    if (!violation) {
      refuse(Status::not_converged, "a contact begins or ends at a waypoint; give another guess, or move it");
      return std::nullopt;
    }
    refuse(Status::not_converged, describe(*violation));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      intervals[i].from = junctions->arcs()[i].from;
      intervals[i].to = junctions->arcs()[i].to;
    }
    before.emplace(*std::move(junctions));
    multipliers_ = before->multipliers();
    path = [&before](double t, std::span<double> q) { point_of(*before, t, q); };
    const double middle = (violation->from + violation->to) / 2;
    const double half = (violation->to - violation->from) / 2 * (violation->forbidden ? 1 : freed_stretch);
    change(intervals, violation->constraint, violation->forbidden, middle - half, middle + half,
           problem_.duration.value);
  }
  return std::nullopt;
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
  free.guess = extremal::guess_of(path.solved().front().trajectory);
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
