#include "study/guess/polyline.hpp"

#include <algorithm>
#include <cmath>

#include "study/guess/waypoint_times.hpp"

namespace extremal {
namespace {

/// Samples between two points that the guess has in all.
constexpr int samples = 1024;

/// Known values of one coordinate, at ascending times t/T.
struct Known {
  std::vector<double> tau, value;
  double at(double x) const {
    if (tau.empty()) return 0;
    const auto after = std::ranges::upper_bound(tau, x);
    if (after == tau.begin()) return value.front();
    if (after == tau.end()) return value.back();
    const auto k = static_cast<std::size_t>(after - tau.begin());
    const double part = (x - tau[k - 1]) / (tau[k] - tau[k - 1]);
    return value[k - 1] + part * (value[k] - value[k - 1]);
  }
};

/// The distance of two points by the coordinates that both have.
double distance(const std::vector<std::pair<int, double>>& a, const std::vector<std::pair<int, double>>& b) {
  double sum = 0;
  for (const auto& [i, x] : a)
    for (const auto& [j, y] : b)
      if (i == j) sum += (x - y) * (x - y);
  return std::sqrt(sum);
}

std::vector<std::pair<int, double>> end_values(const Problem& problem, bool at_end) {
  std::vector<std::pair<int, double>> values;
  const int n = problem.coordinates();
  for (int a = 0; a < n; ++a)
    if (const int e = at_end ? n + a : a; problem.ends.fixed[e])
      values.emplace_back(a, problem.ends.offset[e]);
  return values;
}

/// Where free, times in proportion to the distances between points.
void time_by_distance(std::vector<WaypointCondition>& waypoints, const Problem& problem) {
  const double duration = problem.duration.value;
  for (std::size_t first = 0; first < waypoints.size();) {
    if (!waypoints[first].free) {
      ++first;
      continue;
    }
    std::size_t last = first;
    while (last < waypoints.size() && waypoints[last].free) ++last;
    const double from = first > 0 ? waypoints[first - 1].time / duration : 0,
                 to = last < waypoints.size() ? waypoints[last].time / duration : 1;
    std::vector<double> sums{0};
    auto before = first > 0 ? waypoints[first - 1].fixed : end_values(problem, false);
    for (std::size_t k = first; k <= last; ++k) {
      const auto& here = k < waypoints.size() ? waypoints[k].fixed : end_values(problem, true);
      sums.push_back(sums.back() + distance(before, here));
      before = here;
    }
    const double all = sums.back(), count = static_cast<double>(last - first + 1);
    for (std::size_t k = first; k < last; ++k) {
      const double equal = static_cast<double>(k - first + 1) / count;
      // Half by distance, so that points of which little is known stay apart.
      const double part = all > 0 ? (sums[k - first + 1] / all + equal) / 2 : equal;
      waypoints[k].time = from + part * (to - from);
    }
    first = last;
  }
}

/// Whether any time of a path may be its first: it is closed, and nothing is given at a time.
bool begins_anywhere(const Extension& extension, const Problem& problem) {
  return problem.periodic && problem.lagrangian->structure().autonomous && !problem.duration.where &&
         extension.conditions.empty() && extension.where.empty() &&
         std::ranges::all_of(extension.waypoints, &WaypointCondition::free);
}

}  // namespace

std::vector<double> guessed_times(const std::vector<WaypointCondition>& waypoints, double duration) {
  std::vector<double> times;
  for (const WaypointCondition& w : waypoints) times.push_back(w.free ? w.time : w.time / duration);
  return times;
}

void guess_through(Extension& extension, Problem& problem) {
  std::vector<WaypointCondition>& waypoints = extension.waypoints;
  if (problem.guess.given())
    return begins_anywhere(extension, problem) ? begin_between(waypoints, problem)
                                               : time_by_guess(waypoints, problem);
  time_by_distance(waypoints, problem);
  const std::size_t n = problem.coordinates();
  std::vector<Known> known(n);
  const auto add = [&](double tau, const std::vector<std::pair<int, double>>& values) {
    for (const auto& [a, x] : values) {
      known[a].tau.push_back(tau);
      known[a].value.push_back(x);
    }
  };
  add(0, end_values(problem, false));
  const std::vector<double> times = guessed_times(waypoints, problem.duration.value);
  for (std::size_t w = 0; w < times.size(); ++w) add(times[w], waypoints[w].fixed);
  add(1, end_values(problem, true));
  Guess& guess = problem.guess;
  for (int k = 0; k <= samples; ++k) guess.tau.push_back(static_cast<double>(k) / samples);
  guess.tau.insert(guess.tau.end(), times.begin(), times.end());
  std::ranges::sort(guess.tau);
  guess.tau.erase(std::unique(guess.tau.begin(), guess.tau.end()), guess.tau.end());
  for (const double tau : guess.tau)
    for (const Known& coordinate : known) guess.q.push_back(coordinate.at(tau));
}

}  // namespace extremal
