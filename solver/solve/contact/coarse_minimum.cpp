#include "solve/contact/coarse_minimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "problem/inequalities.hpp"
#include "problem/point_range.hpp"
#include "solve/contact/coarse_action.hpp"
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

/// Whether nodes that move straight from one path to another pass through what is excluded: the other path
/// may pass an obstacle on its other side.
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
    for (int k = 1; k < points; ++k) {
      const double part = static_cast<double>(k) / points;
      for (std::size_t a = 0; a < n; ++a) q[a] = (1 - part) * from[node * n + a] + part * to[node * n + a];
      const ConstraintValues values = problem.inequalities->all->at(q, action.time(node));
      for (Eigen::Index c = 0; c < values.g.size(); ++c)
        if (values.g[c] < -deep * values.slopes.row(c).norm()) return true;
    }
  }
  return false;
}

/// The minimum that short steps lead to: each minimises the action within a box about the path before.
MinimumReport confined_minimum(const CoarseAction& action, std::vector<double>& z, double size,
                               const Deadline& deadline) {
  const double reach = confined_step * size;
  InequalityMinimum minimum = action.minimum(z, size);
  MinimumReport report;
  for (int k = 0; k < most_confined && !deadline.passed(); ++k) {
    const std::vector<double> before = z;
    minimum.lower = minimum.upper = before;
    for (double& x : minimum.lower) x -= reach;
    for (double& x : minimum.upper) x += reach;
    report = minimise(minimum, z, deadline);
    if (!report.converged) return report;
    double moved = 0;
    for (std::size_t i = 0; i < z.size(); ++i) moved = std::max(moved, std::abs(z[i] - before[i]));
    if (moved < confined_end * reach) return report;
  }
  report.converged = false;
  return report;
}

/// The minimum near a path: on the same side of obstacles where there is one.
MinimumReport near_minimum(const Problem& problem, const CoarseAction& action, std::vector<double>& z,
                           const Deadline& deadline) {
  const std::size_t n = problem.coordinates();
  std::vector<double> direct = z;
  MinimumReport report = minimise(action.minimum(z, unit_of(z, n)), direct, deadline);
  const double size = std::max(unit_of(z, n), largest_range(direct, n));
  if (report.converged && crosses(problem, action, z, direct, size)) {
    std::vector<double> confined = z;
    MinimumReport other = confined_minimum(action, confined, size, deadline);
    if (other.converged) {
      z = std::move(confined);
      return other;
    }
  }
  z = std::move(direct);
  return report;
}

/// A zero of the closing condition of coarse minima, as a function of the duration.
class DurationSearch {
 public:
  DurationSearch(Problem& problem, int elements, std::vector<double>& z, const Deadline& deadline)
      : problem_(problem), elements_(elements), z_(z), deadline_(deadline) {}

  CoarseMinimum run() {
    const double guess = problem_.duration.value;
    std::optional<Point> old = at(guess);
    // Shorter paths are minimisers where longer ones are not.
    for (int k = 0; !old && k < most_halvings && !deadline_.passed(); ++k)
      old = at(guess * std::pow(0.5, k + 1));
    if (!old) return {std::move(report_), {}};
    std::optional<Point> now = at(old->duration * first_ratio);
    if (!now) now = at(old->duration / first_ratio);
    int vain = 0;
    for (int k = 0; k < most_durations && now && vain < most_vain_durations && !deadline_.passed(); ++k) {
      if (std::abs(now->duration - old->duration) <= near_duration * now->duration || now->value == 0)
        return {std::move(report_), {}};
      if ((now->value < 0) != (old->value < 0)) other_side_ = old;
      double next = secant(*old, *now);
      std::optional<Point> found = at(next);
      for (int halved = 0; !found && halved < most_halvings; ++halved) {
        next = (next + now->duration) / 2;
        found = at(next);
      }
      old = now;
      now = found;
      const double before = std::abs(nearest_.value);
      if (now && std::abs(now->value) < before) nearest_ = *now;
      vain = other_side_ || std::abs(nearest_.value) < useful_share * before ? 0 : vain + 1;
    }
    report_.converged = false;
    return {std::move(report_), reason()};
  }

 private:
  struct Point {
    double duration, value;
  };

  std::string reason() const {
    if (!std::isfinite(nearest_.value) || other_side_) return {};
    if (closed_by_condition(problem_))
      return fmt::format(
          "minimisers do not satisfy 'where': they come nearest to it, by {:.3g}, at a duration of {:.6g}",
          nearest_.value, nearest_.duration);
    return fmt::format(
        "no minimiser near the guess has this energy: the nearest is {:.6g}, at a duration of {:.6g}",
        nearest_.value + *problem_.duration.energy, nearest_.duration);
  }

  /// The path there becomes the next guess; nothing where there is no minimum, or only one on another side of
  /// an obstacle than the last.
  std::optional<Point> at(double duration) {
    problem_.duration.value = duration;
    const CoarseAction action(problem_, elements_);
    const std::size_t n = problem_.coordinates();
    std::vector<double> z = z_;
    MinimumReport report = continued_ ? minimise(action.minimum(z, unit_of(z, n)), z, deadline_)
                                      : near_minimum(problem_, action, z, deadline_);
    const bool found = report.converged && !(continued_ && crosses(problem_, action, z_, z, unit_of(z, n)));
    if (!found && !continued_) report_ = std::move(report);
    if (!found) return std::nullopt;
    report_ = std::move(report);
    continued_ = true;
    z_ = std::move(z);
    const double value = action.closing(z_);
    if (!std::isfinite(value)) return std::nullopt;
    return Point{duration, value};
  }

  /// Between values of different signs the zero stays enclosed.
  double secant(const Point& old, const Point& now) const {
    double next = now.duration - now.value * (now.duration - old.duration) / (now.value - old.value);
    if (!std::isfinite(next)) next = now.duration * first_ratio;
    if (other_side_ && (now.value < 0) != (other_side_->value < 0)) {
      const auto [low, high] = std::minmax(now.duration, other_side_->duration);
      return next > low && next < high ? next : (low + high) / 2;
    }
    return std::clamp(next, now.duration / most_ratio, now.duration * most_ratio);
  }

  Problem& problem_;
  int elements_;
  std::vector<double>& z_;
  const Deadline& deadline_;
  MinimumReport report_;
  std::optional<Point> other_side_;
  bool continued_ = false;      ///< `z_` is a minimum
  Point nearest_{0, INFINITY};  ///< the least value so far
};

}  // namespace

CoarseMinimum coarse_minimum(Problem& problem, int elements, std::vector<double>& z,
                             const Deadline& deadline) {
  if (problem.duration.free) return DurationSearch(problem, elements, z, deadline).run();
  const CoarseAction action(problem, elements);
  return {near_minimum(problem, action, z, deadline), {}};
}

}  // namespace extremal
