#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "solve/branch/continuation.hpp"

/// \file Places on a step where a test is zero, or of another sign than at both ends.

namespace extremal {

/// What is met on a step is located to this, relative to the distance wanted.
inline constexpr double located = 1e-11;

/// A test that is zero counts as positive: of two steps that meet there one sees it.
inline bool changes_sign(double a, double b) { return (a < 0) != (b < 0) && std::isfinite(a + b); }

/// Where the parabola through three readings is zero, between two of opposite signs: the chord where they are
/// all that there is.
inline double parabola_root(const Reading& a, const Reading& b, const std::optional<Reading>& third) {
  const double reach = b.at - a.at, slope = (b.value - a.value) / reach;
  const double off = third ? third->at - a.at : 0;
  const double bend = third ? ((third->value - a.value) / off - slope) / (off - reach) : 0;
  // a + (slope − bend reach) x + bend x² = 0
  const double half = 0.5 * (slope - bend * reach), root = std::sqrt(half * half - bend * a.value);
  const double x = -a.value / (half + std::copysign(root, slope));
  return std::isfinite(x) && x * reach > 0 && std::abs(x) < std::abs(reach) ? a.at + x
                                                                            : a.at - a.value / slope;
}

/// Where along the tangent test(), read at the place, is zero: by parabolas through the ends of the interval
/// and the reading before, or a third one that is known (Muller 1956). To where done(value, next change)
/// holds. NaN where the branch cannot be followed.
template <class Test, class Done>
double Continuation::root(const Stand& from, Reading low, Reading high, std::optional<Reading> third,
                          const Test& test, const Done& done) {
  constexpr int most_trials = 60, most_parabolas = 8;
  double at = parabola_root(low, high, third);
  for (int k = 0; k < most_trials; ++k) {
    if (!go(from, at)) return NAN;
    const Reading here = {at, test()};
    if (!std::isfinite(here.value)) return NAN;
    third = std::exchange(here.value * high.value > 0 ? high : low, here);
    const double next =
        (k + 1) % most_parabolas == 0 ? 0.5 * (low.at + high.at) : parabola_root(low, high, third);
    // A test that jumps is not zero where a parabola through the jump is.
    const double by_chord = here.value * (at - third->at) / (third->value - here.value);
    const double change = std::max(std::abs(next - at), std::abs(by_chord));
    if (here.value == 0 || done(here.value, change)) return at;
    at = next;
  }
  return NAN;
}

/// Folds and the like, at each of which use() is called: between places of opposite signs. `beside` them
/// the test is known, or foreseen.
template <class Test, class Use>
void Continuation::find_roots(const Stand& from, const std::vector<Reading>& places,
                              std::optional<Reading> beside, const Test& test, const Use& use) {
  for (std::size_t k = 1; k < places.size(); ++k) {
    if (!changes_sign(places[k - 1].value, places[k].value)) continue;
    const std::optional<Reading> third =
        places.size() == 2 ? beside : places[k + 1 < places.size() ? k + 1 : k - 2];
    const double at = root(from, places[k - 1], places[k], third, test,
                           [this](double, double change) { return settled(change); });
    if (std::isfinite(at)) use(at);
  }
}

/// A place where test() has not the sign that it has at both ends, on the way to its least size: from `at`,
/// by parabolas through three places. Nothing where they say that it keeps off zero.
template <class Test>
std::optional<Reading> Continuation::dip(const Stand& from, const Reading& low, const Reading& high,
                                         double at, const Test& test) {
  constexpr int most_trials = 12;
  constexpr double clear = 0.5, near = 1e-3;
  const double sign = std::copysign(1.0, low.value), length = high.at - low.at;
  Reading left = low, right = high;
  std::optional<Reading> middle;
  for (int k = 0; k < most_trials; ++k) {
    if (!go(from, at)) return std::nullopt;
    Reading next = {at, test()};
    if (std::isnan(next.value)) return std::nullopt;
    if (sign * next.value < 0) return next;
    if (!middle) {
      middle = next;
    } else {
      if (sign * next.value < sign * middle->value) std::swap(next, *middle);
      (next.at < middle->at ? left : right) = next;
    }
    const double a = left.at - middle->at, b = right.at - middle->at;
    const double u = (left.value - middle->value) / a, v = (right.value - middle->value) / b;
    const double bend = (v - u) / (b - a), slope = u - a * bend, off = -0.5 * slope / bend;
    const bool turns = sign * bend > 0 && off > a && off < b;
    if (!turns || std::abs(off) <= near * length) return std::nullopt;
    if (k > 0 && sign * (middle->value + 0.5 * slope * off) > clear * sign * middle->value)
      return std::nullopt;
    at = middle->at + off;
  }
  return std::nullopt;
}

}  // namespace extremal
