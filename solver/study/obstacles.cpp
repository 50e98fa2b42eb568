#include "study/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "problem/inequalities.hpp"

namespace extremal {
namespace {

/// Cells along each side of the plane in which the boundary is a line; fewer where it moves.
constexpr int many_cells = 200, few_cells = 100;
/// Steps of time at which a boundary that moves is drawn.
constexpr int moving_steps = 24;

using Point = std::array<double, 2>;

/// The side of a cell that a boundary crosses: its lower or left corner, and whether it is upright.
using Side = std::array<int, 3>;

/// The curve g = 0 in a box, by marching squares: linear between the corners of cells.
class Contour {
 public:
  template <class Function>
  Contour(Point low, Point high, int cells, const Function& g)
      : low_(low), high_(high), cells_(cells), values_((cells + 1) * (cells + 1)) {
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) value(i, j) = g(corner(i, j));
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) cross(i, j);
  }

  /// Pieces of the curve, each from side to side as far as it goes.
  std::vector<PlaneCurve> curves() {
    std::vector<PlaneCurve> found;
    while (!next_.empty()) {
      Side at = next_.begin()->first;
      for (const auto& [side, others] : next_)  // one that begins at the rim, if there is any
        if (others.size() == 1) {
          at = side;
          break;
        }
      PlaneCurve curve;
      add(at, curve);
      while (const std::optional<Side> to = take(at)) {
        at = *to;
        add(at, curve);
      }
      found.push_back(std::move(curve));
    }
    return found;
  }

 private:
  double& value(int i, int j) { return values_[j * (cells_ + 1) + i]; }
  Point corner(int i, int j) const {
    return {low_[0] + (high_[0] - low_[0]) * i / cells_, low_[1] + (high_[1] - low_[1]) * j / cells_};
  }

  /// Joins the sides of a cell where the sign of g changes.
  void cross(int i, int j) {
    std::vector<Side> crossed;
    const auto look = [&](const Side& side) {
      const double a = value(side[0], side[1]), b = value(side[0] + 1 - side[2], side[1] + side[2]);
      if (std::isfinite(a) && std::isfinite(b) && (a < 0) != (b < 0)) crossed.push_back(side);
    };
    look({i, j, 0});
    look({i + 1, j, 1});
    look({i, j + 1, 0});
    look({i, j, 1});
    for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) {
      next_[crossed[k]].push_back(crossed[k + 1]);
      next_[crossed[k + 1]].push_back(crossed[k]);
    }
  }

  void add(const Side& side, PlaneCurve& curve) {
    const Point a = corner(side[0], side[1]), b = corner(side[0] + 1 - side[2], side[1] + side[2]);
    const double ga = value(side[0], side[1]), gb = value(side[0] + 1 - side[2], side[1] + side[2]);
    const double part = ga / (ga - gb);
    curve.x.push_back(a[0] + part * (b[0] - a[0]));
    curve.y.push_back(a[1] + part * (b[1] - a[1]));
  }

  /// One neighbour of a side; both forget that they are joined.
  std::optional<Side> take(const Side& from) {
    const auto found = next_.find(from);
    if (found == next_.end()) return std::nullopt;
    const Side to = found->second.back();
    found->second.pop_back();
    if (found->second.empty()) next_.erase(found);
    if (const auto other = next_.find(to); other != next_.end()) {
      std::erase(other->second, from);
      if (other->second.empty()) next_.erase(other);
    }
    return to;
  }

  Point low_, high_;
  int cells_;
  std::vector<double> values_;
  std::map<Side, std::vector<Side>> next_;
};

}  // namespace

std::vector<PlaneCurve> obstacle_boundaries(const Problem& problem, const Trajectory& trajectory,
                                            double beside) {
  std::vector<PlaneCurve> found;
  const std::size_t n = problem.coordinates();
  if (!problem.inequalities || n > 2 || trajectory.nodes.empty()) return found;
  const Inequalities& inequalities = *problem.inequalities;
  Point low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (std::size_t k = 0; k < trajectory.nodes.size(); ++k) {
    const std::size_t axis = n == 1 ? 1 : k % 2;
    low[axis] = std::min(low[axis], trajectory.nodes[k]);
    high[axis] = std::max(high[axis], trajectory.nodes[k]);
  }
  double side = high[1] - low[1];
  if (n == 2) side = std::max(side, high[0] - low[0]);
  if (!(side > 0)) side = 1;
  for (int axis = n == 1 ? 1 : 0; axis < 2; ++axis) {
    low[axis] -= beside * side;
    high[axis] += beside * side;
  }
  if (n == 1) {
    low[0] = 0;
    high[0] = trajectory.duration();
  }
  const std::vector<double> first(trajectory.nodes.begin(), trajectory.nodes.begin() + n);
  const double duration = trajectory.duration();
  const auto add = [&](int k, int cells, std::optional<double> t) {
    Contour contour(low, high, cells, [&](const Point& point) {
      return n == 1 ? inequalities.all->at(std::array{point[1]}, point[0]).g[k]
                    : inequalities.all->at(point, t.value_or(0)).g[k];
    });
    for (PlaneCurve& curve : contour.curves()) {
      curve.t = t;
      found.push_back(std::move(curve));
    }
  };
  for (int k = 0; k < inequalities.count(); ++k) {
    // A time at which no rate that varies is likely to vanish.
    const bool moves = n == 2 && inequalities.all->at(first, 0.3 * duration).rates[k] != 0;
    if (!moves) add(k, many_cells, std::nullopt);
    for (int i = 0; moves && i <= moving_steps; ++i) add(k, few_cells, duration * i / moving_steps);
  }
  return found;
}

}  // namespace extremal
