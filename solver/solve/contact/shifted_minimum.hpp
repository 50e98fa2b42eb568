#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "solve/contact/coarse_minimum.hpp"
#include "solve/contact/junctions.hpp"

/// \file Where a closed path begins.

namespace extremal {

/// A closed path that may be shifted in time is made to begin between its last waypoint and its first, in the
/// middle of the longest interval there, if a contact begins or ends next to t = 0, or a waypoint is there.
/// Free times of the problem are shifted too. Whether that was so.
bool shift_in_time(Problem& problem, const std::vector<Interval>& intervals, CoarseMinimum& minimum);

}  // namespace extremal
