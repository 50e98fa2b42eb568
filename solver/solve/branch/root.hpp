#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
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

/// Two zeros are looked for down to this share of a step, by at most so many samples.
inline constexpr double least_interval = 1e-3;
inline constexpr std::size_t most_samples = 12;

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
    const double change = std::min(std::max(std::abs(next - at), std::abs(by_chord)), high.at - low.at);
    if (here.value == 0 || done(here.value, change)) return at;
    at = next;
  }
  return NAN;
}

/// The test at the states before a step and at both ends of it: value(state) of an EarlierTests or a
/// BranchState, and `last`, the one at the end in the units of the beginning. Values that are not known are
/// left out.
template <class Value>
std::vector<Sample> samples_on(const BranchStep& step, const Value& value, double last) {
  std::vector<Sample> samples;
  for (auto before = step.from.earlier.rbegin(); before != step.from.earlier.rend(); ++before)
    if (const double known = value(*before); std::isfinite(known)) samples.push_back({-before->back, known});
  samples.push_back({0, value(step.from)});
  samples.push_back({step.length, last});
  return samples;
}

/// Whether the test may pass zero twice between the last two samples, which are of one sign: by its
/// interpolant, less what that errs by, or if it changes twice as fast there as between any samples.
bool may_dip(const std::vector<Sample>& samples);

/// Where, between neighbours of one sign, interpolants do not exclude that the test has the other sign: their
/// value after a sample was added, less by what that changed.
std::optional<double> unresolved(const std::vector<Sample>& before, const std::vector<Sample>& after,
                                 double low, double high);

/// A place between neighbouring samples where another one is wanted.
struct Doubt {
  double low, at, high;
};

/// Samples where there are doubts, the first ones first, and where these leave doubts, down to intervals of
/// `least`. read(at): the test there; NaN if it is not known, or enough are.
template <class Read>
void resolve_doubts(std::vector<Sample>& samples, std::deque<Doubt> doubts, double least, const Read& read) {
  for (; !doubts.empty(); doubts.pop_front()) {
    const Doubt& doubt = doubts.front();
    const Sample sample{doubt.at, read(doubt.at)};
    if (!std::isfinite(sample.value)) return;
    const std::vector<Sample> before = samples;
    samples.insert(std::ranges::find_if(samples, [&](const Sample& each) { return each.at > sample.at; }),
                   sample);
    const std::pair<double, double> halves[] = {{doubt.low, doubt.at}, {doubt.at, doubt.high}};
    for (const auto& [left, right] : halves)
      if (right - left > least)
        if (const auto at = unresolved(before, samples, left, right)) doubts.push_back({left, *at, right});
  }
}

/// Samples between the last two where the test may pass zero twice; see resolve_doubts().
template <class Read>
void resolve(std::vector<Sample>& samples, const Read& read) {
  const double length = samples.back().at;
  if (may_dip(samples)) resolve_doubts(samples, {{0, 0.5 * length, length}}, least_interval * length, read);
}

/// All zeros of a test beyond zero between samples of opposite signs; use(at) is called at each. `beside`: a
/// sample that is predicted.
template <class Test, class Use>
void find_roots(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
                const std::vector<Sample>& samples, std::optional<Sample> beside, const Test& test,
                const Use& use) {
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (samples[k].at <= 0 || !changes_sign(samples[k - 1].value, samples[k].value)) continue;
    std::optional<Sample> third = beside;
    if (!third && k + 1 < samples.size()) third = samples[k + 1];
    if (!third && k > 1) third = samples[k - 2];
    const double at = root(tracker, from, samples[k - 1], samples[k], third, test,
                           [&](double, double change) { return is_located(tracker, family, change); });
    if (std::isfinite(at)) use(at);
  }
}

}  // namespace extremal
