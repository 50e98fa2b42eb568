#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/continuation.hpp"

/// \file What is met on a step along a branch: folds, crossings, the value wanted, the first point again.

namespace extremal {

namespace {

/// Folds and crossings are located to this, relative to the distance wanted, or to as much of the step.
constexpr double located = 1e-11, least_part = 1e-13;
constexpr int most_trials = 60;
/// From this near, relative to the distance wanted, Newton's method lands on a value.
constexpr double near_value = 1e-3;
/// Half the length that the derivative of the action is checked over.
constexpr double probe = 0.01;
/// Two points of a closed branch differ by no more than this, relative.
constexpr double same = 1e-6;

}  // namespace

/// Where along the tangent test(), read at the place, is zero: the secant through ends of the interval, one
/// of which is weighted less when it stays (Illinois). To where `enough` bounds value × last change. NaN
/// where the branch cannot be followed.
template <class Test>
double Continuation::root(const Stand& from, double low, double at_low, double high, double at_high,
                          const Test& test, double enough) {
  double last = low;
  for (int k = 0; k < most_trials; ++k) {
    const double at = (low * at_high - high * at_low) / (at_high - at_low);
    if (!go(from, at)) return NAN;
    const double value = test();
    if (std::abs(value * (at - last)) <= enough || at == last) return at;
    last = at;
    if (value * at_high < 0) {
      low = std::exchange(high, at);
      at_low = std::exchange(at_high, value);
    } else {
      high = at;
      at_high = value;
      at_low *= 0.5;
    }
  }
  return NAN;
}

/// |∂varied/∂s| times the distance from the fold bounds how much more or less it is there.
double Continuation::find_fold(const Stand& from, const Stand& to, double length) {
  if (!(from.rate * to.rate < 0)) return NAN;
  return root(
      from, 0, from.rate, length, to.rate, [this] { return here_.rate; },
      located * std::abs(family_.to - family_.from));
}

double Continuation::find_crossing(const Stand& from, const Stand& to, double length) {
  const bool odd = from.orientation != to.orientation;
  if (!odd && std::abs(from.index - to.index) < 2) return NAN;
  double low = 0, high = length;
  const double distance = std::abs(family_.to - family_.from);
  while (high - low > least_part * length) {
    const double middle = 0.5 * (low + high);
    if (!go(from, middle)) break;
    const bool beyond = odd ? here_.orientation != from.orientation : here_.index != from.index;
    (beyond ? high : low) = middle;
    if ((high - low) * std::abs(here_.rate) <= located * distance && high - low < 1e-6 * length) break;
  }
  return go(from, high) || go(from, low) ? high : NAN;
}

/// To a value between those before and after: exactly, or, where Newton's method does not land there, nearly.
double Continuation::find_value(const Stand& from, double value, double near, double before, double far,
                                double after) {
  const double distance = std::abs(family_.to - family_.from);
  const auto search = [&](double enough) {
    return root(
        from, near, before - value, far, after - value, [&] { return here_.varied - value; },
        enough * distance * (far - near));
  };
  const double at = search(near_value);
  return std::isfinite(at) && correct(1, &value) && turn() ? at : search(1e-13);
}

void Continuation::meet(const Stand& from, const Stand& to, double length) {
  std::vector<Meeting> met;
  double turned_at = length, turned = to.varied;
  if (const double at = find_fold(from, to, length); std::isfinite(at)) {
    met.push_back({at, read(PointKind::fold)});
    turned_at = at;
    turned = here_.varied;
  }
  if (const double at = find_crossing(from, to, length); std::isfinite(at))
    met.push_back({at, read(PointKind::branch)});
  const double distance = std::abs(family_.to - family_.from);
  const auto search = [&](double value) {
    const auto between = [&](double a, double b) {
      return (a - value) * (b - value) <= 0 && std::abs(a - value) > located * distance;
    };
    if (between(from.varied, turned)) return find_value(from, value, 0, from.varied, turned_at, turned);
    if (turned_at < length && between(turned, to.varied))
      return find_value(from, value, turned_at, turned, length, to.varied);
    return static_cast<double>(NAN);
  };
  if (const double at = search(family_.to); std::isfinite(at)) {
    std::erase_if(met, [&](const Meeting& meeting) { return meeting.at > at; });
    met.push_back({at, read(PointKind::regular)});
    stop(BranchEnd::target, fmt::format("the branch leads to {:.12g}", family_.to));
  } else if (const double back = search(family_.from); std::isfinite(back) && is_first()) {
    std::erase_if(met, [&](const Meeting& meeting) { return meeting.at > back; });
    stop(BranchEnd::closed, "the branch is closed: it came back to its first point");
  }
  std::sort(met.begin(), met.end(), [](const Meeting& a, const Meeting& b) { return a.at < b.at; });
  for (Meeting& meeting : met) found_.push_back(std::move(meeting.point));
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

/// The action a little onward and back against the integral of its derivative, by Simpson's rule.
void Continuation::check_action() {
  const Stand at = here_;
  double action[2], rate[2];
  for (int side = 0; side < 2; ++side) {
    const bool there = go(at, side ? probe : -probe);
    if (there) {
      action[side] = here_.action;
      rate[side] = here_.action_rate * branch_.dot(tangent_, tangent_) / branch_.dot(tangent_, here_.tangent);
    }
    if (!there) {
      here_ = at;
      return;
    }
  }
  here_ = at;
  const double found = (action[1] - action[0]) / (2 * probe);
  const double expected = (rate[0] + 4 * at.action_rate + rate[1]) / 6;
  const double size = std::max(std::abs(at.action), std::abs(at.action_rate));
  if (size > 0) worst_action_slope_ = std::max(worst_action_slope_, std::abs(found - expected) / size);
}

}  // namespace extremal
