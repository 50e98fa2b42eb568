#include "study/continued_by_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "problem/extension.hpp"
#include "problem/own_symmetries.hpp"
#include "problem/singular_ends.hpp"
#include "solution/extension_values.hpp"
#include "solution/guessed_by.hpp"
#include "solve/solve.hpp"

namespace extremal {
namespace {

/// A step is at least this part of the way; steps grow by this factor after each that succeeds.
constexpr double least_step = 1e-4, growth_of_steps = 1.5;
/// Where a path is nearer to its equilibrium than this part of its range, its guess for the next one ends.
constexpr double at_rest = 1e-4;
constexpr int samples = 1024, element_samples = 8;
/// With a scheme, how far a path may move in a step, relative to its range; and, where the index changes, any
/// path in the shortest one: at a branch point hardly, beyond a fold far.
constexpr double most_moved = 0.5, most_moved_at_change = 0.05;
constexpr int compared = 64;  ///< places along both paths

/// Times between which a path is away from its equilibria.
std::pair<double, double> away_from_rest(const Problem& problem, const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  const double T = trajectory.duration();
  std::vector<double> q(n), v(n), low(n, INFINITY), high(n, -INFINITY);
  std::vector<std::vector<double>> path;
  for (int k = 0; k <= samples; ++k) {
    trajectory.at(T * k / samples, q, v);
    for (std::size_t a = 0; a < n; ++a) {
      low[a] = std::min(low[a], q[a]);
      high[a] = std::max(high[a], q[a]);
    }
    path.push_back(q);
  }
  double range = 0;
  for (std::size_t a = 0; a < n; ++a) range = std::max(range, high[a] - low[a]);
  const auto rests = [&](const std::vector<double>& x, const std::vector<double>& at) {
    for (std::size_t a = 0; a < n; ++a)
      if (std::abs(x[a] - at[a]) > at_rest * range) return false;
    return true;
  };
  int first = 0, last = samples;
  const InfiniteEnds& infinite = *problem.infinite;
  while (!infinite.start.empty() && first + 2 < last && rests(path[first + 1], infinite.start)) ++first;
  while (!infinite.end.empty() && first + 2 < last && rests(path[last - 1], infinite.end)) --last;
  return {T * first / samples, T * last / samples};
}

/// Gives a problem the part of a path that is away from rest as its guess.
void guess_by(const Problem& before, const Trajectory& trajectory, Problem& problem) {
  if (!problem.infinite) {
    if (problem.duration.free) problem.duration.value = trajectory.duration();
    problem.guess = guess_of(trajectory, element_samples);
    return;
  }
  const auto [from, to] = away_from_rest(before, trajectory);
  const std::size_t n = trajectory.coordinates;
  std::vector<double> q(n), v(n);
  problem.duration.value = to - from;
  problem.guess = {};
  for (int k = 0; k <= samples; ++k) {
    const double tau = static_cast<double>(k) / samples;
    trajectory.at(std::min(from + tau * (to - from), trajectory.duration()), q, v);
    problem.guess.tau.push_back(tau);
    problem.guess.q.insert(problem.guess.q.end(), q.begin(), q.end());
  }
}

/// Gives a problem the constants and the free times of waypoints that a solution has as its guesses.
void guess_constants_by(const Solution& solution, Problem& problem) {
  if (!problem.extension || !solution.extension) return;
  auto extension = std::make_shared<Extension>(*problem.extension);
  for (std::size_t k = 0; k < extension->guess.size(); ++k)
    extension->guess[k] = solution.extension->unknowns[k].second;
  for (std::size_t w = 0; w < extension->waypoints.size(); ++w)
    if (extension->waypoints[w].free)
      extension->waypoints[w].time = solution.extension->waypoints[w].time / problem.duration.value;
  problem.extension = std::move(extension);
}

/// The problem with this value of what varies, if there is one.
std::optional<Problem> problem_at(const ProblemFamily& family, double value) {
  if (family.varied == Varied::parameter) return family.at(value);
  Problem problem = family.problem;
  if (family.varied == Varied::duration)
    problem.duration.value = value;
  else
    problem.duration.energy = value;
  return problem;
}

/// Of paths of the same problem for two values: the most that a coordinate moves, relative to the largest
/// range of one.
double distance(const Trajectory& a, const Trajectory& b) {
  const std::size_t n = a.coordinates;
  std::vector<double> qa(n), qb(n), v(n), low(n, INFINITY), high(n, -INFINITY);
  double most = 0, range = 0;
  for (int k = 0; k <= compared; ++k) {
    a.at(a.duration() * k / compared, qa, v);
    b.at(b.duration() * k / compared, qb, v);
    for (std::size_t i = 0; i < n; ++i) {
      most = std::max(most, std::abs(qa[i] - qb[i]));
      low[i] = std::min({low[i], qa[i], qb[i]});
      high[i] = std::max({high[i], qa[i], qb[i]});
    }
  }
  for (std::size_t i = 0; i < n; ++i) range = std::max(range, high[i] - low[i]);
  return range > 0 ? most / range : 0;
}

/// The same of paths without an origin of time, between the curves that they run through.
double distance_of_curves(const Trajectory& a, const Trajectory& b) {
  const std::size_t n = a.coordinates;
  const auto points_of = [n](const Trajectory& path) {
    std::vector<std::vector<double>> points(samples + 1, std::vector<double>(n));
    std::vector<double> v(n);
    for (int k = 0; k <= samples; ++k) path.at(path.duration() * k / samples, points[k], v);
    return points;
  };
  const auto apart = [](const std::vector<double>& p, const std::vector<double>& q) {
    double most = 0;
    for (std::size_t i = 0; i < p.size(); ++i) most = std::max(most, std::abs(p[i] - q[i]));
    return most;
  };
  const auto of_a = points_of(a), of_b = points_of(b);
  double most = 0, range = 0;
  for (const std::vector<double>& p : of_a) {
    double least = INFINITY;
    for (const std::vector<double>& q : of_b) least = std::min(least, apart(p, q));
    most = std::max(most, least);
    range = std::max(range, apart(p, of_a.front()));
  }
  return range > 0 ? most / range : 0;
}

/// Whether an extremal is the next one on the branch of another: of the same index, which Newton's method
/// finds (and of a scheme, near it), or, in the shortest step, beyond a branch point.
bool continues(const Solution& before, const Solution& found, const Problem& problem, bool of_scheme,
               bool shortest) {
  if (found.morse_index == before.morse_index)
    return !of_scheme || distance(before.trajectory, found.trajectory) <= most_moved;
  if (!shortest) return false;
  const double moved = problem.infinite ? distance_of_curves(before.trajectory, found.trajectory)
                                        : distance(before.trajectory, found.trajectory);
  return moved <= most_moved_at_change;
}

/// What make_problem() fills in: symmetries, and with forces both copies. Nothing where it is refused.
std::optional<Problem> checked(std::optional<Problem> problem) {
  if (!problem) return std::nullopt;
  try {
    return make_problem(*std::move(problem));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Why there is no step from an extremal to one of the problem `there`.
std::string obstacle(const std::optional<Problem>& there, const Solution& found, const Solution& from) {
  if (!there) return "an end is at no equilibrium that is approached exponentially";
  if (found.converged() && found.morse_index != from.morse_index)
    return "the index changes there, at a fold or a branch point";
  return found.converged() ? "the branch may turn back there"
                           : "the branch may turn back there, or end: " + found.message;
}

BranchPoint point_of(double parameter, const Solution& solution) {
  BranchPoint point{.parameter = parameter, .kind = PointKind::regular, .branch = 0, .solution = solution};
  point.solution.windows.clear();
  point.solution.conjugate_times.clear();
  point.solution.conjugate_times_known = false;
  point.solution.certificate = Certificate::none;
  return point;
}

}  // namespace

bool continued_by_values(const Problem& problem, const SolveOptions& options) {
  return options.scheme || problem.extension || problem.infinite.has_value() ||
         singular_ends(problem).has_value();
}

FollowedBranch follow_by_values(const Study& study, const Continued& continued,
                                const std::function<void(const BranchPoint&)>& progress) {
  FollowedBranch followed;
  followed.title = study.title;
  followed.parameter = continued.parameter;
  followed.names = study.problem.names;
  BranchRecord& record = followed.branches.emplace_back();
  record.worst_action_slope.reset();
  record.worst_momentum.reset();
  SolveOptions options = study.options;
  options.deadline = deadline_of(study);
  const bool of_scheme = options.scheme && !study.problem.infinite;
  Solver solver;
  Problem here = study.problem;
  Solution solution = solver.solve(here, options);
  std::string changes;
  const auto finish = [&](BranchEnd end, std::string message) {
    record.end = end;
    record.message = std::move(message) + changes;
    if (of_scheme && !followed.points.empty())
      record.message += fmt::format(
          "; each point is an extremal of {}, from the one before: folds end the branch, and "
          "branch points and period doublings are not looked for",
          options.scheme->name);
    record.points = static_cast<int>(followed.points.size());
    return std::move(followed);
  };
  if (!solution.converged())
    return finish(BranchEnd::not_started, "no extremal to begin with: " + solution.message);
  const auto add = [&](double value) {
    followed.points.push_back(point_of(value, solution));
    if (progress) progress(followed.points.back());
  };
  const double from = continued.family.from, to = continued.family.to;
  const double longest = (to - from) / std::max(1, continued.points - 1);
  double value = from, step = longest;
  bool bisecting = false;  // between values where the index differs
  add(value);
  while (value != to) {
    if (static_cast<int>(followed.points.size()) >= continued.points)
      return finish(BranchEnd::points, fmt::format("{} points, as many as were asked for", continued.points));
    if (options.deadline.passed()) return finish(BranchEnd::budget, "the budget of time is spent");
    const double next = std::abs(to - value) <= 1.001 * std::abs(step) ? to : value + step;
    std::optional<Problem> there = problem_at(continued.family, next);
    Solution found;
    if (there) {
      guess_by(here, solution.trajectory, *there);
      guess_constants_by(solution, *there);
      if (of_scheme || there->copies)
        there = checked(std::move(there));
      else
        there->symmetries = own_symmetries(*there);
      if (there) found = solver.solve(*there, options);
    }
    const bool shortest = std::abs(step) / 2 <= least_step * std::abs(to - from);
    const bool near = found.converged() && found.strategy == "newton from the guess";
    if (!near || !continues(solution, found, here, of_scheme, shortest)) {
      step /= 2;
      bisecting = found.converged() && found.morse_index != solution.morse_index;
      if (!shortest) continue;
      return finish(there ? BranchEnd::too_short : BranchEnd::limit,
                    fmt::format("beyond {} = {:.10g} Newton's method does not lead on: {}",
                                continued.parameter, value, obstacle(there, found, solution)));
    }
    if (found.morse_index != solution.morse_index) {
      changes += fmt::format(
          "; between {:.10g} and {:.10g} the index changes: another branch begins there, "
          "which is not followed",
          value, next);
      step = longest;
      bisecting = false;
    }
    here = *std::move(there);
    solution = std::move(found);
    value = next;
    bisecting = bisecting && !shortest;
    if (!bisecting) add(value);
    const double growth = bisecting ? 0.5 : growth_of_steps;
    step = std::copysign(std::min(std::abs(longest), growth * std::abs(step)), step);
  }
  return finish(BranchEnd::target, fmt::format("{} is {:.10g}", continued.parameter, to));
}

}  // namespace extremal
