#pragma once

#include <optional>

#include "problem/problem.hpp"

/// \file Ends at whose time L is infinite or the mass vanishes, wherever the path is there.
///
/// As with a force like 1/√t, with a centrifugal term q²/t² in polar coordinates, or with a weight √t. With τ
/// the time from such an end, ∂²L/∂q'² ~ τ^a and ∂L/∂q ~ τ^b, motions are sums of powers of τ: 1, that of a
/// constant momentum, 1 − a, and that which forces add, 2 + b − a. With τ ~ s^k, where all of these times k
/// are whole, they are smooth in s.

namespace extremal {

/// Beside an end, at a point in general position.
struct PowersOfTime {
  double mass = 0;                ///< a
  std::optional<double> force{};  ///< b; nothing where there is no force
  bool infinite = false;          ///< L at the time of the end itself
};

/// Nothing where L is regular at the time of this end, or not by powers.
std::optional<PowersOfTime> powers_of_time(const Problem& problem, bool at_end);

/// k; at least 2, since elements reach the end with s at the rate of its power.
double smoothing_power(const PowersOfTime& powers);

/// An end at which no force holds a value: a motion that is not the one without momentum there leaves any
/// bound, as the logarithm does beside a weight t.
struct LooseEnd {
  bool at_end = false;
  double mass = 0;  ///< see PowersOfTime
};

/// The first end that fixes all coordinates where no force can.
std::optional<LooseEnd> loose_end(const Problem& problem);

}  // namespace extremal
