#include "recurrence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "problem/closing.hpp"
#include "reference.hpp"
#include "refute.hpp"
#include "rivals/verify.hpp"
#include "solution/observe.hpp"

namespace bench {
namespace {

/// Of what the tolerance allows; velocities are ten tolerances off, and so are those of the second time.
constexpr double closing_margin = 10, velocity_margin = 200;
/// An orbit so much smaller than its guess is at rest.
constexpr double at_rest = 1e-9;

/// Column by column: points, or slopes without the constant.
std::vector<double> image(const extremal::ClosingMap& map, const std::vector<double>& values,
                          double constant) {
  const Eigen::Index n = map.r.rows();
  const Eigen::Map<const Eigen::MatrixXd> before(values.data(), n, std::ssize(values) / n);
  const Eigen::MatrixXd after = (map.r * before).colwise() + constant * map.c;
  return {after.data(), after.data() + after.size()};
}

template <class Values>
void append(Values& to, const Values& more) {
  to.insert(to.end(), more.begin(), more.end());
}

extremal::Trajectory twice(const extremal::Trajectory& once, const extremal::ClosingMap& map) {
  extremal::Trajectory path = once;
  for (int k = 1; k <= once.elements(); ++k) path.times.push_back(once.duration() + once.times[k]);
  append(path.nodes, image(map, once.nodes, 1));
  if (!once.slopes.empty()) append(path.slopes, image(map, once.slopes, 0));
  append(path.lengths, once.lengths);
  return path;
}

/// Between the ends of a path, in its duration.
extremal::Problem between_ends(const extremal::Problem& problem, const extremal::Trajectory& path) {
  extremal::Problem result = problem;
  const auto n = static_cast<std::size_t>(problem.coordinates());
  result.periodic = false;
  result.reduction = nullptr;
  result.symmetries.clear();
  result.guess = {};
  result.duration = {path.duration(), false, {}, {}};
  result.boundary = {};
  result.boundary.coordinates = problem.coordinates();
  for (std::size_t a = 0; a < n; ++a) {
    result.boundary.fix(static_cast<int>(a), false, path.nodes[a]);
    result.boundary.fix(static_cast<int>(a), true, path.nodes[path.nodes.size() - n + a]);
  }
  result.ends = solve_relation(result.boundary);
  return result;
}

/// The jump of velocities where the path closes.
double velocity_jump(const extremal::Trajectory& path, const extremal::ClosingMap& map) {
  std::vector<double> q(path.coordinates), first(q.size()), last(q.size());
  path.at(0, q, first);
  path.at(path.duration(), q, last);
  const std::vector<double> onward = image(map, first, 0);
  double jump = 0;
  for (std::size_t a = 0; a < last.size(); ++a) jump = std::max(jump, std::abs(last[a] - onward[a]));
  return jump;
}

double range_of(const extremal::Guess& guess, std::size_t n) {
  double most = 0;
  for (std::size_t a = 0; a < n && guess.given(); ++a) {
    double low = guess.q[a], high = low;
    for (std::size_t k = a; k < guess.q.size(); k += n) {
      low = std::min(low, guess.q[k]);
      high = std::max(high, guess.q[k]);
    }
    most = std::max(most, high - low);
  }
  return most;
}

}  // namespace

std::vector<Fault> deny_recurrence(const extremal::Study& study, const extremal::Solution& solution) {
  const extremal::Problem& problem = study.problem;
  if (!problem.periodic) return {};
  const extremal::Trajectory& path = solution.trajectory;
  const extremal::Survey ranges = survey(*problem.lagrangian, path);
  const double guessed = range_of(problem.guess, problem.coordinates());
  if (guessed > 0 && largest_of(ranges.q) <= at_rest * guessed)
    return {{"false", fmt::format("an equilibrium as an orbit: a range of {:.3g} from a guess of {:.3g}",
                                  largest_of(ranges.q), guessed)}};
  const extremal::ClosingMap map = closing_map(problem);
  if (study.options.scheme || (problem.lagrangian->structure().autonomous && map.identity())) return {};
  const double tolerance = study.options.tolerance, speed = largest_of(ranges.v);
  const double jump = velocity_jump(path, map);
  if (jump > velocity_margin * (tolerance * speed + velocity_roundoff(path)))
    return {{"false", fmt::format("velocities jump by {:.3g} where the orbit closes; they range over {:.3g}",
                                  jump, speed)}};
  const extremal::Trajectory both = twice(path, map);
  const extremal::Verification found =
      verify(between_ends(problem, both), both,
             {.tolerance = tolerance, .margin = std::numeric_limits<double>::max()});
  const double roundoff = velocity_roundoff(path) * path.duration() / (tolerance * size_of(study, path));
  if (found.verified && found.defect > closing_margin + roundoff)
    return {{"false", fmt::format("it does not recur: {:.3g} tolerances off at t = {:.6g} of twice {:.6g}",
                                  found.defect, found.worst_time, path.duration())}};
  return {};
}

}  // namespace bench
