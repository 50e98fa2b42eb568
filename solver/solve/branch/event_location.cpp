#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/continuation.hpp"
#include "solve/branch/root.hpp"
#include "solve/mesh/roundoff.hpp"

/// \file What is met on a step along a branch: folds, the value wanted, rest, the first point again.

namespace extremal {

namespace {

/// From this near, relative to the distance wanted, Newton's method lands on a value.
constexpr double near_value = 1e-3;
/// Half the lengths that the derivative of the action is checked over, until it is found so exact.
constexpr double probes[] = {1e-3, 1e-4, 1e-5}, exact = 1e-9;
/// Two points of a closed branch differ by no more than this, relative.
constexpr double same = 1e-6;
/// What is met within this share of a step is one.
constexpr double one = 1e-2;
/// An orbit this small against the one before the step is next to rest.
constexpr double nearly_rest = 1e-3;

/// Mean over τ of the product of two paths, each less its mean, by the nodes.
double swing(const Path& a, const Path& b) {
  const std::size_t n = a.coordinates(), count = a.elements() + 1;
  const std::vector<double> other = interpolated(b.nodes(), n, b.mesh(), a.mesh());
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double product = 0, mean = 0, other_mean = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double weight = 0.5 * (a.mesh()[std::min(k + 1, count - 1)] - a.mesh()[k > 0 ? k - 1 : 0]);
      const double x = a.nodes()[k * n + i], y = other[k * n + i];
      product += weight * x * y;
      mean += weight * x;
      other_mean += weight * y;
    }
    sum += product - mean * other_mean;
  }
  return sum;
}

}  // namespace

/// Folds and period doublings are located so well.
bool Continuation::settled(double change) const {
  return std::abs(change * here_.rate) <= located * std::abs(family_.to - family_.from) &&
         std::abs(change) <= 1e-8;
}

/// Of the derivative of what varies, on the step, as the parabola tells that has its values at both ends and
/// the integral that it must have: its extremum between, and that in the middle.
struct Continuation::Rates {
  Reading extremum, middle;
};

Continuation::Rates Continuation::rates_between(const Stand& from, const Stand& to, double length) {
  const double first = from.rate, last = to.rate * to.back / length;
  const double mean = (to.varied - from.varied) / length;
  const double slope = 6 * mean - 4 * first - 2 * last, bend = 3 * (first + last - 2 * mean);
  const double at = -slope / (2 * bend);
  const bool between = at > 0 && at < 1;
  return {between ? Reading{at * length, first + 0.5 * slope * at} : Reading{0, first},
          {0.5 * length, first + 0.5 * slope + 0.25 * bend}};
}

bool Continuation::may_fold(const Stand& from, const Stand& to, double length) {
  return from.rate * to.rate < 0 || from.rate * rates_between(from, to, length).extremum.value < 0;
}

/// |∂varied/∂s| times the distance from a fold bounds how much more or less it is there.
void Continuation::find_folds(const Stand& from, const Stand& to, double length, std::vector<Meeting>& met) {
  std::vector<Reading> places = {{0, from.rate}, {length, to.rate * to.back / length}};
  const auto rate = [this] { return here_.rate; };
  const auto [extremum, middle] = rates_between(from, to, length);
  if (from.rate * to.rate > 0 && from.rate * extremum.value < 0)
    if (const auto between = dip(from, places[0], places[1], extremum.at, rate))
      places.insert(places.begin() + 1, *between);
  find_roots(from, places, middle, rate, [&](double at) { met.push_back({at, {read(PointKind::fold)}}); });
}

/// To a value between those before and after: exactly, or, where Newton's method does not land there, nearly.
double Continuation::find_value(const Stand& from, double value, const Reading& near, const Reading& far) {
  const double distance = std::abs(family_.to - family_.from), reach = far.at - near.at;
  const auto search = [&](double enough) {
    return root(
        from, {near.at, near.value - value}, {far.at, far.value - value}, std::nullopt,
        [&] { return here_.varied - value; },
        [&](double off, double change) {
          return std::abs(off) <= std::max(enough * distance, 8 * unit_roundoff * std::abs(value)) ||
                 change <= 2 * unit_roundoff * reach;
        });
  };
  // What varies as a parabola, level at a fold: v(σ) = before + slope σ + bend σ².
  const double slope = near.at == 0 ? from.rate : 0, off = value - near.value;
  const double bend = ((far.value - near.value) / reach - slope) / reach;
  const double guess = 2 * off / (slope + std::copysign(std::sqrt(slope * slope + 4 * bend * off), off));
  if (guess >= 0 && guess <= reach && go(from, near.at + guess, false, &value) && cosine_ > sharpest_turn) {
    const double landed = near.at + guess + landed_;
    if (landed >= near.at && landed <= far.at) return landed;
  }
  const double at = search(near_value);
  return std::isfinite(at) && correct(1, &value) && turn() ? at : search(1e-13);
}

/// Where periodic orbits have all but shrunk to a point: beyond, they would be the same ones half a period
/// later.
double Continuation::find_rest(const Stand& from, const Stand& to, double length) {
  const Problem& problem = branch_.problem();
  if (!problem.periodic || !problem.lagrangian->structure().autonomous) return NAN;
  const double size = swing(from.path, from.path), after = swing(to.path, from.path) / size;
  if (!(after < 0)) return NAN;
  return root(
      from, {0, 1 - nearly_rest}, {length, after - nearly_rest}, std::nullopt,
      [&] { return swing(here_.path, from.path) / size - nearly_rest; },
      [](double off, double) { return std::abs(off) <= 0.1 * nearly_rest; });
}

/// Folds, crossings and period doublings on a step. What varies at its ends and where it turns back.
std::vector<Reading> Continuation::meet_others(const Stand& from, const Stand& to, double length,
                                               std::vector<Meeting>& met) {
  std::vector<Reading> extremes = {{0, from.varied}};
  find_folds(from, to, length, met);
  for (const Meeting& fold : met) extremes.push_back({fold.at, fold.found.point.parameter});
  extremes.push_back({length, to.varied});
  find_crossings(from, to, length, met);
  // A branch that crosses where this one turns back explains the fold, as the half of a pitchfork does.
  std::vector<double> crossings;
  for (std::size_t k = extremes.size() - 2; k < met.size(); ++k) crossings.push_back(met[k].at);
  std::erase_if(met, [&](const Meeting& meeting) {
    return meeting.found.point.kind == PointKind::fold && std::ranges::any_of(crossings, [&](double at) {
             return std::abs(at - meeting.at) <= one * length;
           });
  });
  find_doublings(from, to, length, met);
  return extremes;
}

/// False where the value that the branch is to lead to was passed, and is not found.
bool Continuation::meet(const Stand& start, const Stand& to, double length) {
  const double distance = std::abs(family_.to - family_.from);
  const auto passed = [&](double value, double a, double b) {
    return (a - value) * (b - value) <= 0 && std::abs(a - value) > located * distance;
  };
  std::optional<Stand> aim;
  if (may_fold(start, to, length) || may_double(start, to, length) || differs(start, to) ||
      passed(family_.to, start.varied, to.varied) || passed(first_.varied, start.varied, to.varied))
    aim = aimed(start, to, length);
  const Stand& from = aim ? *aim : start;
  std::vector<Meeting> met;
  const std::vector<Reading> extremes = meet_others(from, to, length, met);
  bool missed = false;
  const auto search = [&](double value, const auto& wanted) {
    for (std::size_t k = 1; k < extremes.size(); ++k) {
      if (!passed(value, extremes[k - 1].value, extremes[k].value)) continue;
      const double at = find_value(from, value, extremes[k - 1], extremes[k]);
      if (std::isfinite(at) && wanted()) return at;
      missed = true;
    }
    return double(NAN);
  };
  const auto ends_at = [&](double at, BranchEnd end, std::string message) {
    std::erase_if(met, [&](const Meeting& meeting) { return meeting.at > at; });
    stop(end, std::move(message));
  };
  if (const double at = search(family_.to, [] { return true; }); std::isfinite(at)) {
    BranchPoint last = read(PointKind::regular);
    ends_at(at, BranchEnd::target, fmt::format("the branch leads to {:.12g}", family_.to));
    met.push_back({at, {std::move(last)}});
  } else if (missed) {
    return false;
  } else if (const double back = search(first_.varied, [&] { return is_first(); }); std::isfinite(back)) {
    ends_at(back, BranchEnd::closed, "the branch is closed: it came back to its first point");
  } else if (const double rest = find_rest(from, to, length); std::isfinite(rest)) {
    BranchPoint last = read(PointKind::regular);
    ends_at(rest, BranchEnd::rest,
            fmt::format("at {:.8g} the orbits shrink onto an equilibrium, with the period {:.8g}",
                        here_.varied, here_.path.duration()));
    met.push_back({rest, {std::move(last)}});
  }
  std::sort(met.begin(), met.end(), [](const Meeting& a, const Meeting& b) { return a.at < b.at; });
  for (Meeting& meeting : met) found_.push_back(std::move(meeting.found));
  return true;
}

/// Whether the place is the first point, passed in the same direction.
bool Continuation::is_first() const {
  const auto equal = [](double a, double b) {
    return std::abs(a - b) <= same * std::max(std::abs(a), std::abs(b));
  };
  return here_.rate * first_.rate > 0 && equal(here_.action, first_.action) &&
         equal(here_.coordinate, first_.coordinate) && here_.orientation == first_.orientation &&
         equal(here_.path.duration(), first_.path.duration());
}

/// The action a little onward and back against the integral of its derivative, by Simpson's rule; nearer by
/// where that is not exact enough.
void Continuation::check_action() {
  const Stand at = here_;
  // −E T alone may be large: S vanishes for small swings.
  const double size = std::max({std::abs(at.action), std::abs(at.action_rate), at.energy_time});
  double least = INFINITY;
  for (const double by : probes) {
    double action[2], rate[2];
    bool there = size > 0;
    for (int side = 0; side < 2 && there; ++side) {
      there = go(at, side ? by : -by, true);
      action[side] = here_.action;
      rate[side] = here_.action_rate * branch_.dot(tangent_, tangent_) / branch_.dot(tangent_, here_.tangent);
    }
    if (!there) continue;
    const double found = (action[1] - action[0]) / (2 * by);
    const double expected = (rate[0] + 4 * at.action_rate + rate[1]) / 6;
    least = std::min(least, std::abs(found - expected) / size);
    if (least < exact) break;
  }
  here_ = at;
  if (least < INFINITY) worst_action_slope_ = std::max(worst_action_slope_, least);
}

}  // namespace extremal
