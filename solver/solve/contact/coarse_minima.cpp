#include "solve/contact/coarse_minima.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/point_range.hpp"
#include "solve/contact/found_values.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// What units and steps are taken from; of a path that is a point, how far it is from zero.
double unit_of(const std::vector<double>& z, std::size_t n) {
  constexpr double roundoff = 1e-9;
  const double size = largest_range(z, n);
  double largest = 0;
  for (const double x : z) largest = std::max(largest, std::abs(x));
  if (size > roundoff * largest) return size;
  return largest > 0 ? largest : 1;
}

/// Whether nodes that move straight from one path to another pass through what is excluded, deeper than where
/// they begin: the other path may pass an obstacle on its other side.
bool crosses(const Problem& problem, const CoarseAction& action, const std::vector<double>& from,
             const std::vector<double>& to, double size) {
  const std::size_t n = problem.coordinates(), m = problem.inequalities->count();
  const double deep = crossing_depth * size;
  std::vector<double> q(n);
  for (std::size_t place = 0; place < action.places().size(); place += m) {
    const int node = action.places()[place].node;
    double moved = 0;
    for (std::size_t a = 0; a < n; ++a)
      moved = std::max(moved, std::abs(to[node * n + a] - from[node * n + a]));
    const int points = static_cast<int>(std::min(moved / deep, crossing_points));
    Eigen::VectorXd least;  // on an obstacle that has moved over the path nodes begin within it
    for (int k = 0; k < points; ++k) {
      const double part = static_cast<double>(k) / points;
      for (std::size_t a = 0; a < n; ++a) q[a] = (1 - part) * from[node * n + a] + part * to[node * n + a];
      const ConstraintValues values = problem.inequalities->all->at(q, action.time(node));
      if (k == 0) least = values.g.cwiseMin(0);
      for (Eigen::Index c = 0; c < values.g.size(); ++c)
        if (values.g[c] < least[c] - deep * values.slopes.row(c).norm()) return true;
    }
  }
  return false;
}

/// The minimum that short steps lead to: each minimises the action within a box about the path before.
MinimumReport confined_minimum(const CoarseAction& action, std::vector<double>& x, double size,
                               const Deadline& deadline) {
  const double reach = confined_step * size;
  InequalityMinimum minimum = action.minimum(action.nodes_of(x), size);
  MinimumReport report;
  for (int k = 0; k < most_confined && !deadline.passed(); ++k) {
    const std::vector<double> before = x;
    minimum.lower = minimum.upper = before;
    for (double& low : minimum.lower) low -= reach;
    for (double& high : minimum.upper) high += reach;
    report = minimise(minimum, x, deadline);
    if (!report.converged) return report;
    double moved = 0;
    for (std::size_t i = 0; i < x.size(); ++i) moved = std::max(moved, std::abs(x[i] - before[i]));
    if (moved < confined_end * reach) return report;
  }
  report.converged = false;
  return report;
}

CoarsePath path_of(const CoarseAction& action, const std::vector<double>& x, double size) {
  return {action.nodes_of(x), action.times_at(x, size)};
}

MinimumReport direct_minimum(const CoarseAction& action, CoarsePath& path, const Deadline& deadline) {
  const double size = unit_of(path.z, action.coordinates());
  std::vector<double> x = action.variables(path.z, size);
  MinimumReport report = minimise(action.minimum(path.z, size), x, deadline);
  path = path_of(action, x, size);
  return report;
}

/// The minimum near a path: on the same side of obstacles where there is one.
MinimumReport near_minimum(const Problem& problem, const CoarseAction& action, CoarsePath& path,
                           const Deadline& deadline) {
  const std::size_t n = problem.coordinates();
  CoarsePath direct = path;
  MinimumReport report = direct_minimum(action, direct, deadline);
  const double size = std::max(unit_of(path.z, n), largest_range(direct.z, n));
  if (report.converged && crosses(problem, action, path.z, direct.z, size)) {
    std::vector<double> confined = action.variables(path.z, size);
    MinimumReport other = confined_minimum(action, confined, size, deadline);
    if (other.converged) {
      path = path_of(action, confined, size);
      return other;
    }
  }
  path = std::move(direct);
  return report;
}

/// Of the waypoints whose times are given; 0: there are none.
double last_given_time(const Problem& problem) {
  double last = 0;
  if (problem.extension)
    for (const WaypointCondition& waypoint : problem.extension->waypoints)
      if (!waypoint.free) last = waypoint.time;
  return last;
}

/// Nodes of a path at other times; each part of the duration stays the same.
std::vector<double> nodes_between(const CoarsePath& path, std::size_t n, const std::vector<double>& times) {
  Guess guess;
  for (const double t : path.times) guess.tau.push_back(t / path.times.back());
  guess.q = path.z;
  std::vector<double> nodes(times.size() * n);
  for (std::size_t k = 0; k < times.size(); ++k) guess.at(times[k] / times.back(), {nodes.data() + k * n, n});
  return nodes;
}

}  // namespace

CoarseMinima::CoarseMinima(const Problem& problem, CoarseElements elements, std::vector<double> z,
                           const Deadline& deadline)
    : elements_(std::move(elements)),
      deadline_(deadline),
      last_{problem, {std::move(z), coarse_times(problem, elements_)}} {}

bool CoarseMinima::find(double duration, const std::vector<double>& unknowns) {
  std::optional<Minimum> found = at(duration, unknowns);
  if (found) last_ = *std::move(found);
  return found.has_value();
}

std::optional<CoarseMinima::Minimum> CoarseMinima::at(double duration, const std::vector<double>& unknowns) {
  Minimum found{last_.problem, {}};
  // Points whose times are given come before.
  if (last_given_time(found.problem) >= duration) return std::nullopt;
  found.problem.duration.value = duration;
  put_unknowns(unknowns, found.problem);
  const CoarseAction action(found.problem, elements_);
  found.path = {nodes_between(last_.path, action.coordinates(), action.times()), action.times()};
  const std::vector<double> before = found.path.z;
  const bool first = last_.report.multipliers.empty();
  found.report = first ? near_minimum(found.problem, action, found.path, deadline_)
                       : direct_minimum(action, found.path, deadline_);
  if (first && !found.report.converged) failure_ = found.report;
  const double size = unit_of(found.path.z, action.coordinates());
  if (!found.report.converged || (!first && crosses(found.problem, action, before, found.path.z, size)))
    return std::nullopt;
  put_free_times(action.free_waypoints(), found.path.times, found.problem);
  const CoarseAction there(found.problem, found.path.times);
  if (found.problem.duration.free)
    found.closing = there.closing(found.path.z, action.integral_multipliers(found.report));
  found.where = there.where(found.path.z);
  const bool finite = std::isfinite(found.closing) &&
                      std::ranges::all_of(found.where, [](double x) { return std::isfinite(x); });
  return finite ? std::optional(std::move(found)) : std::nullopt;
}

}  // namespace extremal
