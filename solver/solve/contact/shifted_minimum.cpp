#include "solve/contact/shifted_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "problem/closing.hpp"
#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// Whether q(T) = q(0), and any time may be the first one.
bool may_be_shifted(const Problem& problem) {
  if (!problem.shifts_in_time() || problem.duration.where) return false;
  if (const Extension* const e = problem.extension.get(); e && !(e->conditions.empty() && e->where.empty()))
    return false;
  return problem.inequalities->all->autonomous() && closing_map(problem).identity();
}

/// Times between which a path may begin in the next period.
struct Range {
  double from, to;
};

/// Between the last waypoint and the first one, if there are any.
Range beginnings(const Problem& problem) {
  const double duration = problem.duration.value;
  if (!problem.extension || problem.extension->waypoints.empty()) return {0, 2 * duration};
  const std::vector<WaypointCondition>& waypoints = problem.extension->waypoints;
  return {waypoints.back().at(duration), duration + waypoints.front().at(duration)};
}

/// The intervals of two periods within a range.
std::vector<Interval> intervals_within(const Range& range, const std::vector<Interval>& intervals,
                                       double duration) {
  std::vector<Interval> found;
  for (const double later : {0.0, duration})
    for (const Interval& interval : intervals) {
      const double begin = std::max(range.from, interval.from + later),
                   end = std::min(range.to, interval.to + later);
      if (!(begin < end)) continue;
      if (!found.empty() && found.back().held == interval.held)
        found.back().to = end;
      else
        found.push_back({interval.held, begin, end});
    }
  return found;
}

/// The node that is nearest to a time; −1: none is within the range.
int nearest_node(const std::vector<double>& times, const Range& range, double time) {
  int nearest = -1;
  double least = INFINITY;
  for (int k = 0; k + 1 < std::ssize(times); ++k)
    for (const double t : {times[k], times[k] + times.back()})
      if (t > range.from && t < range.to && std::abs(t - time) < least) {
        least = std::abs(t - time);
        nearest = k;
      }
  return nearest;
}

/// The path begins at this node.
void begin_at(int node, const Problem& problem, CoarseMinimum& minimum) {
  const CoarseAction action(problem, minimum.times);
  const int n = action.coordinates();
  std::vector<double>&z = minimum.z, &times = minimum.times, &multipliers = minimum.report.multipliers;
  // Inequalities are compared at some nodes alone.
  const auto place = std::ranges::lower_bound(action.places(), node, {}, &NodeInequality::node);
  std::rotate(multipliers.begin(), multipliers.begin() + (place - action.places().begin()),
              multipliers.end());
  z.resize(z.size() - n);  // the last node is the first one
  std::rotate(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(node) * n, z.end());
  z.insert(z.end(), z.begin(), z.begin() + n);
  const double start = times[node], duration = times.back();
  times.pop_back();
  for (double& t : times) t += t < start ? duration - start : -start;
  std::rotate(times.begin(), times.begin() + node, times.end());
  times.push_back(duration);
}

/// Times of waypoints, all of them free, after this one.
void count_from(double start, Problem& problem) {
  if (!problem.extension) return;
  Extension extension = *problem.extension;
  const double part = start / problem.duration.value;
  for (WaypointCondition& waypoint : extension.waypoints)
    waypoint.time += waypoint.time < part ? 1 - part : -part;
  problem.extension = std::make_shared<const Extension>(std::move(extension));
}

}  // namespace

bool shift_in_time(Problem& problem, const std::vector<Interval>& intervals, CoarseMinimum& minimum) {
  if (!may_be_shifted(problem)) return false;
  const double duration = problem.duration.value;
  const double near = clear_elements * duration / static_cast<double>(minimum.times.size() - 1);
  const Range range = beginnings(problem);
  const std::vector<Interval> found = intervals_within(range, intervals, duration);
  const auto clear = [&](const Interval& i) { return i.from < duration - near && i.to > duration + near; };
  if (std::ranges::any_of(found, clear)) return false;
  const auto longest = std::ranges::max_element(found, {}, [](const Interval& i) { return i.to - i.from; });
  const int node = nearest_node(minimum.times, range, (longest->from + longest->to) / 2);
  if (node <= 0) return false;
  const double start = minimum.times[node];
  begin_at(node, problem, minimum);
  count_from(start, problem);
  return true;
}

}  // namespace extremal
