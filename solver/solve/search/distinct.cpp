#include "solve/search/distinct.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "motion/point.hpp"
#include "problem/point_range.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::distinct;

namespace {

/// Largest range of a coordinate over the nodes, or its largest absolute value where that is negligible.
double extent(const Trajectory& trajectory) {
  const double most = largest_range(trajectory.nodes, trajectory.coordinates);
  double magnitude = 0;
  for (double x : trajectory.nodes) magnitude = std::max(magnitude, std::abs(x));
  return most > 1e-12 * magnitude ? most : magnitude;
}

/// Whether b is nowhere further than `allowed` from a, at the ends of a's elements and twice in between.
/// Periodic paths may be compared with b at times that are `later`.
bool near(const Trajectory& a, const Trajectory& b, double allowed, double later = 0) {
  const std::size_t n = a.coordinates;
  std::vector<double> here(n), there(n), v(n);
  const double stretch = b.duration() / a.duration();
  for (int k = 0; k < a.elements(); ++k)
    for (int part = 0; part < 3; ++part) {
      const double t = a.times[k] + part * (a.times[k + 1] - a.times[k]) / 3;
      a.at(t, here, v);
      const double at = t * stretch + later;
      b.at(later > 0 ? std::fmod(at, b.duration()) : std::min(at, b.duration()), there, v);
      for (std::size_t i = 0; i < n; ++i)
        if (!(std::abs(here[i] - there[i]) <= allowed)) return false;
    }
  return true;
}

bool agree(double a, double b, double size, double tolerance) {
  return std::abs(a - b) <= margin * tolerance * size;
}

/// |p||q| at the ends, which the action is of the order of even where it vanishes.
double action_size(const Solution& a) {
  double momentum = 0;
  for (const auto* p : {&a.momentum_start, &a.momentum_end})
    for (double x : *p) momentum = std::max(momentum, std::abs(x));
  return std::abs(a.action) + momentum * extent(a.trajectory);
}

/// Whether a shift leaves L the same but for a function of t, which moves no path: at points near a, and as
/// far from it as the shift, also beside the line that it is along.
bool invariant(const Lagrangian& lagrangian, const Trajectory& a, const std::vector<double>& shift) {
  const std::size_t n = a.coordinates;
  std::vector<double> here(n), there(n), v(n);
  Scratch scratch;
  double change = 0, most = 0;
  const auto compare = [&](const std::vector<double>& one, const std::vector<double>& other) {
    for (std::size_t i = 0; i < n; ++i) {
      const double by = std::abs(other[i] - one[i]);
      change = std::isnan(by) ? INFINITY : std::max(change, by);
      most = std::max({most, std::abs(one[i]), std::abs(other[i])});
    }
  };
  for (int k = 0; k < a.elements(); ++k)
    for (std::size_t j = 0; j < std::size(shifted); ++j) {
      a.at(a.times[k], here, v);
      for (std::size_t i = 0; i < n; ++i) {
        here[i] += shifted[(i + j) % std::size(shifted)] * shift[i];
        there[i] = here[i] + shift[i];
      }
      const PointValues value = evaluate_at(lagrangian, here, v, a.times[k], Order::gradient, scratch),
                        moved = evaluate_at(lagrangian, there, v, a.times[k], Order::gradient, scratch);
      compare(value.dq, moved.dq);
      compare(value.dv, moved.dv);
    }
  return std::isfinite(change) && change <= unchanged * most;
}

}  // namespace

bool same_path(const Solution& a, const Solution& b, double tolerance, double scale) {
  const double size = std::max({extent(a.trajectory), extent(b.trajectory), rest * scale});
  const double allowed = margin * (a.error_estimate + b.error_estimate + tolerance * size);
  const double relative = size > 0 ? allowed / size : tolerance;
  if (std::abs(a.duration() - b.duration()) > relative * a.duration()) return false;
  return near(a.trajectory, b.trajectory, allowed) && near(b.trajectory, a.trajectory, allowed);
}

bool same_continuum(const Solution& a, const Solution& b, double tolerance) {
  const bool continuum = a.nullity.value_or(0) > 0 && a.nullity == b.nullity;
  return continuum && a.morse_index == b.morse_index && same_orbit(a, b, tolerance);
}

bool same_orbit(const Solution& a, const Solution& b, double tolerance) {
  const double size = std::max(extent(a.trajectory), extent(b.trajectory));
  const double error = size > 0 ? (a.error_estimate + b.error_estimate) / size + tolerance : tolerance;
  const double energy = 2 * std::numbers::pi * action_size(a) / a.duration();
  if (a.energy && b.energy && !agree(*a.energy, *b.energy, energy, error)) return false;
  return agree(a.duration(), b.duration(), a.duration(), error) &&
         agree(a.action, b.action, std::max(action_size(a), action_size(b)), error);
}

bool same_but_for_place(const Lagrangian& lagrangian, const Solution& a, const Solution& b,
                        std::optional<double> period, double tolerance) {
  const std::size_t n = a.trajectory.coordinates;
  const double size = std::max(extent(a.trajectory), extent(b.trajectory)), duration = b.duration();
  const double allowed = margin * (a.error_estimate + b.error_estimate + tolerance * size);
  std::vector<double> shift(n), v(n);
  for (double later = 0; later < (1 - tolerance) * duration; later += period.value_or(duration)) {
    b.trajectory.at(later, shift, v);
    for (std::size_t i = 0; i < n; ++i) shift[i] -= a.trajectory.nodes[i];
    Trajectory moved = b.trajectory;
    for (std::size_t k = 0; k < moved.nodes.size(); ++k) moved.nodes[k] -= shift[k % n];
    const bool in_place = std::ranges::all_of(shift, [&](double x) { return std::abs(x) <= allowed; });
    if (near(a.trajectory, moved, allowed, later) &&
        near(moved, a.trajectory, allowed, later > 0 ? duration - later : 0) &&
        ((in_place && later > 0) || invariant(lagrangian, a.trajectory, shift)))
      return true;
  }
  return false;
}

bool same_discrete(const Solution& a, const Solution& b) {
  const double size = std::max(extent(a.trajectory), extent(b.trajectory));
  return a.trajectory.nodes.size() == b.trajectory.nodes.size() &&
         agree(a.duration(), b.duration(), a.duration(), amplified_roundoff) &&
         near(a.trajectory, b.trajectory, margin * amplified_roundoff * size);
}

void sort_by_action(std::vector<Solution>& solutions) {
  std::stable_sort(solutions.begin(), solutions.end(),
                   [](const Solution& a, const Solution& b) { return a.action < b.action; });
}

}  // namespace extremal
