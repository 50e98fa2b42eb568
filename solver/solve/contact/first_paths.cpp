#include "solve/contact/first_paths.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "problem/manifold.hpp"
#include "solve/contact/aside.hpp"
#include "solve/contact/limits.hpp"
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
  const Inequalities& inequalities = *problem.inequalities;
  const std::size_t n = problem.coordinates();
  for (std::size_t place = 0; place < action.places().size(); place += inequalities.count()) {
    const int node = action.places()[place].node;
    const std::span<double> q(z.data() + node * n, n);
    bool kept = false;
    for (int pass = 0; pass < most_pushes && !kept; ++pass) {
      const ConstraintValues values = inequalities.all->at(q, action.time(node));
      Eigen::Index worst = 0;
      const double least = values.g.minCoeff(&worst);
      kept = least >= 0;
      if (kept) break;
      const VectorXd slope = values.slopes.row(worst), across = inequalities.all->metric() * slope;
      const double square = slope.dot(across);
      if (!(square > 0)) return false;
      // A step slightly beyond, so that rounding does not keep the node outside.
      const VectorXd step = -(1 + 1e-6) * least / square * across;
      for (std::size_t a = 0; a < n; ++a) q[a] += step[a];
      if (problem.manifold && !problem.manifold->project(q, action.time(node))) return false;
    }
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

/// How far nodes are moved to one side of what an inequality forbids: the tent of least slope over it.
struct Side {
  bool needed = false;  ///< the unmoved path is forbidden
  std::vector<double> distance;
};

/// Raises neighbours so that the distance changes by no more than `step` from node to node, from zero at the
/// ends.
void make_tent(std::vector<double>& distance, double step) {
  const std::size_t last = distance.size() - 1;
  for (std::size_t k = 1; k <= last; ++k) distance[k] = std::max(distance[k], distance[k - 1] - step);
  for (std::size_t k = last; k-- > 0;) distance[k] = std::max(distance[k], distance[k + 1] - step);
  for (std::size_t k = 0; k <= last; ++k)
    distance[k] = std::min(distance[k], step * static_cast<double>(std::min(k, last - k)));
}

/// The side of an inequality, where one is within reach: nodes go beyond all that it forbids there.
std::optional<Side> side_of(const Problem& problem, const CoarseAction& action, const Nodes& line,
                            const VectorXd& direction, double size, int constraint, double sign) {
  const std::size_t n = problem.coordinates();
  Side side{false, std::vector<double>(action.elements() + 1)};
  std::vector<double> q(n);
  bool within = false;
  for (int node = 1; node < action.elements(); ++node)
    for (int k = 0; k <= side_points; ++k) {
      const double distance = size * k / side_points;
      for (std::size_t a = 0; a < n; ++a) q[a] = line[node * n + a] + sign * distance * direction[a];
      if (!(problem.inequalities->all->at(q, action.time(node)).g[constraint] < 0)) continue;
      if (k == side_points) return std::nullopt;
      within = true;
      side.needed = side.needed || k == 0;
      side.distance[node] = size * (k + 1) / side_points;
    }
  if (!within) return std::nullopt;
  make_tent(side.distance, side_slope * size / action.elements());
  return side;
}

}  // namespace

std::vector<std::vector<double>> paths_by_sides(const Problem& problem, const CoarseAction& action) {
  const int n = problem.coordinates();
  if (problem.periodic) return {};
  const Nodes line = unbent(problem, action);
  const VectorXd direction = across_line(line, n, 0);
  const double size = size_of(line, n);
  // Of each inequality the sides that may be chosen; one that is out of the way may be left as it is.
  std::vector<std::vector<std::vector<double>>> choices;
  std::size_t count = 1;
  for (int c = 0; c < problem.inequalities->count(); ++c) {
    std::vector<std::vector<double>> moves;
    bool needed = false;
    for (const double sign : {1.0, -1.0})
      if (std::optional<Side> side = side_of(problem, action, line, direction, size, c, sign)) {
        needed = needed || side->needed;
        for (double& x : side->distance) x *= sign;
        moves.push_back(std::move(side->distance));
      }
    if (!needed) moves.insert(moves.begin(), std::vector<double>(action.elements() + 1));
    if (moves.size() < 2 || count * moves.size() > most_sides) continue;
    count *= moves.size();
    choices.push_back(std::move(moves));
  }
  std::vector<std::pair<double, Nodes>> paths;
  for (std::size_t number = 0; number < count && !choices.empty(); ++number) {
    Nodes z = line;
    double moved = 0;
    for (int node = 0; node <= action.elements(); ++node) {
      double up = 0, down = 0;
      std::size_t rest = number;
      for (const auto& moves : choices) {
        const double by = moves[rest % moves.size()][node];
        rest /= moves.size();
        up = std::max(up, by);
        down = std::min(down, by);
      }
      moved += std::abs(up + down);
      for (int a = 0; a < n; ++a) z[static_cast<std::size_t>(node) * n + a] += (up + down) * direction[a];
    }
    if (push(problem, action, z) && !jumps(z, n)) paths.emplace_back(moved, std::move(z));
  }
  std::ranges::stable_sort(paths, {}, &std::pair<double, Nodes>::first);
  std::vector<Nodes> sorted;
  for (auto& [moved, z] : paths) sorted.push_back(std::move(z));
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
