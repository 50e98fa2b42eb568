#include "solve/adapt/stationary_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "solve/adapt/limits.hpp"
#include "solve/newton/ends.hpp"
#include "solve/periodic/phase.hpp"

namespace extremal {

using namespace limits::stationary_phase;

StationaryPhase::StationaryPhase(const Problem& problem, NewtonIteration& newton, const ElementTables& tables,
                                 Solve solve)
    : problem_(problem), newton_(newton), tables_(tables), solve_(std::move(solve)) {}

/// The part of a node that two elements share comes from both; of the ends, of which each has one of them, as
/// they are related.
void StationaryPhase::measure_direction(const Path& path) {
  const std::size_t n = path.coordinates(), last = path.elements() * n;
  direction_.assign(last + n, 0);
  add_shift_of_time(path, tables_.scheme(), direction_.data());
  std::vector<double> moved = ends_of(path);
  for (std::size_t a = 0; a < n; ++a) {
    moved[a] += 2 * direction_[a];
    moved[n + a] += 2 * direction_[last + a];
  }
  const std::vector<double> before = ends_of(path), after = nearest_ends(problem_.ends, moved);
  for (std::size_t a = 0; a < n; ++a) {
    direction_[a] = after[a] - before[a];
    direction_[last + a] = after[n + a] - before[n + a];
  }
}

StationaryPhase::Point StationaryPhase::measured(double shift, Path path) {
  const double residual = newton_.residual_at(path);
  const DiscreteAction& action = newton_.action();
  measure_direction(path);
  const std::size_t n = path.coordinates(), last = path.elements() * n, lanes = path.lanes();
  double force = 0;
  for (std::size_t a = 0; a < n; ++a)
    force += action.imbalance(static_cast<int>(a)) * direction_[a] +
             action.imbalance(static_cast<int>(n + a)) * direction_[last + a];
  for (std::size_t k = 0; k * n < last; ++k)
    for (std::size_t a = 0; a < n; ++a) {
      const double* const at = action.end_gradients(static_cast<int>(k / lanes)) + a * lanes + k % lanes;
      if (k > 0) force += at[0] * direction_[k * n + a];
      if ((k + 1) * n < last) force += at[n * lanes] * direction_[(k + 1) * n + a];
    }
  return {shift, force, residual / action.momentum_scale(), std::move(path)};
}

bool StationaryPhase::shift(const Point& from, double to, Point& result) {
  Path path = from.path;
  measure_direction(path);
  const std::size_t padded_elements = static_cast<std::size_t>(path.batches()) * path.lanes();
  path.add(direction_, AlignedDoubles(padded_elements * tables_.unknowns()), to - from.shift);
  meet_ends(problem_, path);
  if (!solve_(path)) return false;
  result = measured(to, std::move(path));
  return true;
}

/// Outward in both senses, until the force changes its sign.
bool StationaryPhase::bracket(const Path& path, Point& a, Point& b) {
  std::array<Point, 2> reached{measured(0, path), {}};
  reached[1] = reached[0];
  std::array<bool, 2> open{true, true};
  for (int k = 1; k <= most_shifts; ++k)
    for (const int side : {0, 1}) {
      if (!open[side]) continue;
      Point next;
      open[side] = shift(reached[side], (side == 0 ? k : -k) * shift_part, next);
      if (!open[side]) continue;
      if (std::signbit(next.force) != std::signbit(reached[side].force)) {
        a = std::move(reached[side]);
        b = std::move(next);
        return true;
      }
      reached[side] = std::move(next);
    }
  return false;
}

/// Regula falsi; an end that stays for a second time is weighed less (Illinois).
StationaryPhase::Point StationaryPhase::zero_between(Point a, Point b) {
  double of_a = a.force, of_b = b.force;
  int stays = 0;  // how often a has, or, negative, b
  for (int k = 0; k < most_zero_steps && std::min(a.residual, b.residual) > unforced; ++k) {
    Point next;
    const double to = (a.shift * of_b - b.shift * of_a) / (of_b - of_a);
    if (!shift(a.residual < b.residual ? a : b, to, next)) break;
    const bool beside_b = std::signbit(next.force) == std::signbit(b.force);
    stays = beside_b ? std::max(stays, 0) + 1 : std::min(stays, 0) - 1;
    if (stays > 1) of_a /= 2;
    if (stays < -1) of_b /= 2;
    (beside_b ? of_b : of_a) = next.force;
    (beside_b ? b : a) = std::move(next);
  }
  return a.residual < b.residual ? std::move(a) : std::move(b);
}

bool StationaryPhase::find(Path& path, double enough) {
  Point a, b;
  if (!bracket(path, a, b)) return false;
  Point found = zero_between(std::move(a), std::move(b));
  if (!(found.residual <= enough)) return false;
  path = std::move(found.path);
  return true;
}

}  // namespace extremal
