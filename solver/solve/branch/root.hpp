#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "solve/branch/tracker.hpp"

/// \file States on a step where a test is zero, or of another sign than at both ends.

namespace extremal {

/// Of a test on a step: how far along the tangent, and its value.
struct Sample {
  double at, value;
};

/// Events are located to this, relative to the distance wanted, and to so much of the tangent.
inline constexpr double located = 1e-11, located_length = 1e-8;

/// A test that is zero counts as positive: of two steps that end there one finds it.
inline bool changes_sign(double a, double b) { return (a < 0) != (b < 0) && std::isfinite(a + b); }

/// Where the parabola through three samples is zero, between two of opposite signs: the chord where they are
/// all that there is.
inline double parabola_root(const Sample& a, const Sample& b, const std::optional<Sample>& third) {
  const double reach = b.at - a.at, slope = (b.value - a.value) / reach;
  const double off = third ? third->at - a.at : 0;
  const double bend = third ? ((third->value - a.value) / off - slope) / (off - reach) : 0;
  // a + (slope − bend reach) x + bend x² = 0
  const double half = 0.5 * (slope - bend * reach), root = std::sqrt(half * half - bend * a.value);
  const double x = -a.value / (half + std::copysign(root, slope));
  return std::isfinite(x) && x * reach > 0 && std::abs(x) < std::abs(reach) ? a.at + x
                                                                            : a.at - a.value / slope;
}

/// Whether a change of the length moves the tracker's state by no more than events are located to.
inline bool is_located(const Tracker& tracker, const ProblemFamily& family, double change) {
  return std::abs(change * tracker.state.rate) <= located * std::abs(family.to - family.from) &&
         std::abs(change) <= located_length;
}

/// How far along the tangent test(), read at the tracker's state, is zero: by parabolas through the ends of
/// the interval and the sample before, or a third one that is known (Muller 1956). To where done(value, next
/// change) holds. NaN where the branch cannot be followed.
template <class Test, class Done>
double root(Tracker& tracker, const BranchState& from, Sample low, Sample high, std::optional<Sample> third,
            const Test& test, const Done& done) {
  constexpr int most_trials = 60, most_parabolas = 8, most_closer = 4;
  double at = parabola_root(low, high, third), reached = NAN;
  for (int k = 0; k < most_trials; ++k) {
    // Factors that are singular to roundoff give no tangent: as at a fold itself, though not beside it.
    for (int closer = 0; !tracker.reach(from, at); ++closer) {
      if (closer == most_closer || !std::isfinite(reached)) return NAN;
      at = 0.5 * (at + reached);
    }
    const Sample here = {at, test()};
    if (!std::isfinite(here.value)) return NAN;
    reached = at;
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

/// All zeros of a test between samples of opposite signs; use(at) is called at each. `beside`: a sample that
/// is known or predicted.
template <class Test, class Use>
void find_roots(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
                const std::vector<Sample>& samples, std::optional<Sample> beside, const Test& test,
                const Use& use) {
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (!changes_sign(samples[k - 1].value, samples[k].value)) continue;
    const std::optional<Sample> third =
        samples.size() == 2 ? beside : samples[k + 1 < samples.size() ? k + 1 : k - 2];
    const double at = root(tracker, from, samples[k - 1], samples[k], third, test,
                           [&](double, double change) { return is_located(tracker, family, change); });
    if (std::isfinite(at)) use(at);
  }
}

/// A sample of a test whose sign differs from that at both ends, on the way to its least size: from `at`, by
/// parabolas through three samples. Nothing where they predict that it keeps off zero.
template <class Test>
std::optional<Sample> dip(Tracker& tracker, const BranchState& from, const Sample& low, const Sample& high,
                          double at, const Test& test) {
  constexpr int most_trials = 12;
  constexpr double clear = 0.5, near = 1e-3;
  const double sign = std::copysign(1.0, low.value), length = high.at - low.at;
  Sample left = low, right = high;
  std::optional<Sample> middle;
  for (int k = 0; k < most_trials; ++k) {
    if (!tracker.reach(from, at)) return std::nullopt;
    Sample next = {at, test()};
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
