#include "solve/contact/first_paths.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "solve/contact/aside.hpp"
#include "solve/contact/limits.hpp"
#include "solve/contact/tight_path.hpp"
#include "solve/guess/starting_ends.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::VectorXd;

using Nodes = std::vector<double>;

Nodes unbent(const Problem& problem, const CoarseAction& action) {
  const std::size_t n = problem.coordinates();
  const std::vector<double> ends = starting_ends(problem);
  Nodes z((action.elements() + 1) * n);
  for (int k = 0; k <= action.elements(); ++k) {
    const double tau = action.time(k) / problem.duration.value;
    if (problem.guess.given() && k > 0 && k < action.elements()) {
      problem.guess.at(tau, {z.data() + k * n, n});
      continue;
    }
    for (std::size_t a = 0; a < n; ++a) z[k * n + a] = (1 - tau) * ends[a] + tau * ends[n + a];
  }
  return z;
}

/// The extent of the path and of what it must keep clear of, roughly.
double size_of(const Nodes& z, int n) {
  double size = 0, least = 0;
  for (int a = 0; a < n; ++a) {
    double low = z[a], high = z[a];
    for (std::size_t i = a; i < z.size(); i += n) {
      low = std::min(low, z[i]);
      high = std::max(high, z[i]);
    }
    size = std::max(size, high - low);
    least = std::max({least, std::abs(low), std::abs(high)});
  }
  return size > 0 ? size : least > 0 ? least : 1;
}

/// Moves the nodes to where all inequalities hold; false where that fails.
bool push(const Problem& problem, const CoarseAction& action, Nodes& z) {
  const std::size_t n = problem.coordinates();
  for (std::size_t place = 0; place < action.places().size(); place += problem.inequalities->count()) {
    const int node = action.places()[place].node;
    const std::span<double> q(z.data() + node * n, n);
    if (!push_node(problem, q, action.time(node))) return false;
  }
  return true;
}

bool jumps(const Nodes& z, std::size_t n) {
  double length = 0, longest = 0;
  for (std::size_t k = n; k < z.size(); k += n) {
    double step = 0;
    for (std::size_t a = 0; a < n; ++a) step += std::pow(z[k + a] - z[k + a - n], 2);
    length += std::sqrt(step);
    longest = std::max(longest, std::sqrt(step));
  }
  return longest > jump * length && length > 0;
}

void bend(Nodes& z, const VectorXd& direction, double size, int wave) {
  const auto n = static_cast<std::size_t>(direction.size());
  const double nodes = static_cast<double>(z.size()) / static_cast<double>(n) - 1;
  for (std::size_t k = 0; k < z.size() / n; ++k)
    for (std::size_t a = 0; a < n; ++a)
      z[k * n + a] +=
          size * direction[a] * std::sin(wave * std::numbers::pi * static_cast<double>(k) / nodes);
}

constexpr int signs = 2, sizes = static_cast<int>(std::size(wave_sizes));

/// Directions of the bends of a search.
int directions(int n) { return n == 1 ? 1 : n == 2 ? 1 : n; }

/// What an inequality forbids at each node: distances along a direction from the path that is not moved.
struct Obstacle {
  std::vector<double> low, high;              ///< infinite where nothing is forbidden
  double nearest = INFINITY;                  ///< of them all
  bool open_below = true, open_above = true;  ///< whether it ends there within reach
};

/// Those within reach.
std::vector<Obstacle> obstacles_within(double size, const Problem& problem, const CoarseAction& action,
                                       const Nodes& line, const VectorXd& direction) {
  const std::size_t n = problem.coordinates();
  const int last = action.elements();
  std::vector<Obstacle> all(problem.inequalities->count(), {std::vector<double>(last + 1, INFINITY),
                                                            std::vector<double>(last + 1, -INFINITY)});
  std::vector<double> q(n);
  for (int node = 1; node < last; ++node)
    for (int k = -side_points; k <= side_points; ++k) {
      const double distance = size * k / side_points, beyond = size / side_points;
      for (std::size_t a = 0; a < n; ++a) q[a] = line[node * n + a] + distance * direction[a];
      const ConstraintValues values = problem.inequalities->all->at(q, action.time(node));
      for (std::size_t c = 0; c < all.size(); ++c) {
        if (!(values.g[static_cast<Eigen::Index>(c)] < 0)) continue;
        Obstacle& obstacle = all[c];
        obstacle.low[node] = std::min(obstacle.low[node], distance - beyond);
        obstacle.high[node] = distance + beyond;
        obstacle.nearest = std::min(obstacle.nearest, std::abs(distance));
        if (k == -side_points) obstacle.open_below = false;
        if (k == side_points) obstacle.open_above = false;
      }
    }
  std::erase_if(all, [](const Obstacle& obstacle) { return obstacle.nearest == INFINITY; });
  return all;
}

/// Those within the size of the path, the nearest first. What does not end within it may do so farther away,
/// as far as `reach` then is.
std::vector<Obstacle> obstacles(const Problem& problem, const CoarseAction& action, const Nodes& line,
                                const VectorXd& direction, double& reach) {
  const auto ends = [](const Obstacle& obstacle) { return obstacle.open_below && obstacle.open_above; };
  std::vector<Obstacle> all = obstacles_within(reach, problem, action, line, direction);
  double farther = reach;
  for (int k = 0; k < most_reaches && !std::ranges::all_of(all, ends); ++k) {
    std::vector<Obstacle> more = obstacles_within(farther *= 2, problem, action, line, direction);
    if (std::ranges::count_if(more, ends) <= std::ranges::count_if(all, ends)) continue;
    all = std::move(more);
    reach = farther;
  }
  std::ranges::stable_sort(all, {}, &Obstacle::nearest);
  return all;
}

/// Between what lies below it and what lies above it, a path is moved as little as may be, by no more than
/// `step` from node to node and not at the ends.
struct Corridor {
  std::vector<double> low, high;

  explicit Corridor(int last) : low(last + 1, -INFINITY), high(last + 1, INFINITY) {}

  void keep_above(const Obstacle& obstacle) {
    for (std::size_t k = 0; k < low.size(); ++k) low[k] = std::max(low[k], obstacle.high[k]);
  }
  void keep_below(const Obstacle& obstacle) {
    for (std::size_t k = 0; k < low.size(); ++k) high[k] = std::min(high[k], obstacle.low[k]);
  }
  bool closed() const {
    for (std::size_t k = 0; k < low.size(); ++k)
      if (low[k] > high[k]) return true;
    return false;
  }
  std::vector<double> distances(double step) const {
    const std::size_t last = low.size() - 1;
    std::vector<double> least = low, most = high, result(last + 1);
    for (std::size_t k = 1; k <= last; ++k) {
      least[k] = std::max(least[k], least[k - 1] - step);
      most[k] = std::min(most[k], most[k - 1] + step);
    }
    for (std::size_t k = last; k-- > 0;) {
      least[k] = std::max(least[k], least[k + 1] - step);
      most[k] = std::min(most[k], most[k + 1] + step);
    }
    for (std::size_t k = 0; k <= last; ++k) {
      const double reach = step * static_cast<double>(std::min(k, last - k));
      const double wanted =
          least[k] <= most[k] ? std::clamp(0.0, least[k], most[k]) : (least[k] + most[k]) / 2;
      result[k] = std::clamp(std::clamp(wanted, low[k], high[k]), -reach, reach);
    }
    return result;
  }
};

double largest_difference(const Nodes& a, const Nodes& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

std::vector<FirstPath> paths_by_sides(const Problem& problem, const CoarseAction& action) {
  const int n = problem.coordinates();
  if (problem.periodic) return {};
  const Nodes line = unbent(problem, action);
  const VectorXd direction = across_line(line, n, 0);
  const double size = size_of(line, n);
  const int last = action.elements();
  double reach = size;
  const std::vector<Obstacle> all = obstacles(problem, action, line, direction, reach);
  // Those that leave no choice, and those beyond what can be combined, are passed on the side where they end,
  // or on that on which the path moves less.
  Corridor forced(last);
  std::vector<Obstacle> chosen;
  for (const Obstacle& obstacle : all) {
    const bool choice = obstacle.open_below && obstacle.open_above;
    if (choice && std::size_t(2) << chosen.size() <= most_sides) {
      chosen.push_back(obstacle);
    } else if (obstacle.open_above || obstacle.open_below) {
      const double up = std::ranges::max(obstacle.high), down = -std::ranges::min(obstacle.low);
      const bool above = obstacle.open_above && (!obstacle.open_below || up < down);
      above ? forced.keep_above(obstacle) : forced.keep_below(obstacle);
    }
  }
  // Integrals and free waypoints are not kept while a path is pulled tight, nor are constraints.
  const bool may_pull = !problem.extension && !problem.manifold;
  std::vector<FirstPath> tight, loose;
  for (std::size_t number = 0; number < std::size_t(1) << chosen.size() && !chosen.empty(); ++number) {
    Corridor corridor = forced;
    for (std::size_t i = 0; i < chosen.size(); ++i)
      (number >> i) % 2 == 0 ? corridor.keep_above(chosen[i]) : corridor.keep_below(chosen[i]);
    if (corridor.closed()) continue;
    const std::vector<double> distances = corridor.distances(side_slope * reach / last);
    Nodes z = line;
    double moved = 0;
    for (int node = 0; node <= last; ++node) {
      moved += std::abs(distances[node]);
      for (int a = 0; a < n; ++a) z[static_cast<std::size_t>(node) * n + a] += distances[node] * direction[a];
    }
    if (!push(problem, action, z) || jumps(z, n)) continue;
    std::optional<TightPath> pulled = may_pull ? pulled_tight(problem, action, z) : std::nullopt;
    if (pulled)
      tight.push_back({std::move(pulled->z), pulled->action});
    else
      loose.push_back({std::move(z), {}, moved});
  }
  std::ranges::stable_sort(tight, {}, [](const FirstPath& path) { return *path.action; });
  std::ranges::stable_sort(loose, {}, &FirstPath::moved);
  std::vector<FirstPath> sorted;
  for (FirstPath& path : tight)
    if (std::ranges::none_of(sorted, [&](const FirstPath& other) {
          return largest_difference(path.nodes, other.nodes) <= one_tight_path * size;
        }))
      sorted.push_back(std::move(path));
  std::ranges::move(loose, std::back_inserter(sorted));
  return sorted;
}

std::vector<double> first_path(const Problem& problem, const CoarseAction& action) {
  const int n = problem.coordinates();
  const Nodes line = unbent(problem, action);
  const double size = size_of(line, n);
  Nodes pushed = line;
  push(problem, action, pushed);
  for (const double part : bends) {
    Nodes z = line;
    bend(z, across_line(line, n, 0), part * size, 1);
    if (push(problem, action, z) && !jumps(z, n) && !cuts_through(problem, action, z)) return z;
  }
  Nodes aside = line;
  return move_aside(problem, action, aside) ? aside : pushed;
}

int bent_paths(const Problem& problem) { return signs * sizes * waves * directions(problem.coordinates()); }

/// Small waves first; of each size half a wave, then more.
std::optional<std::vector<double>> bent_path(const Problem& problem, const CoarseAction& action, int number) {
  const int n = problem.coordinates();
  const int sign = number % signs, direction = number / signs % directions(n),
            wave = number / signs / directions(n) % waves, size = number / signs / directions(n) / waves;
  Nodes z = unbent(problem, action);
  const double extent = size_of(z, n);
  bend(z, across_line(z, n, direction), (sign == 0 ? 1 : -1) * wave_sizes[size] * extent, wave + 1);
  if (!push(problem, action, z) || jumps(z, n)) return std::nullopt;
  return z;
}

}  // namespace extremal
