#pragma once

#include <span>
#include <vector>

#include "solve/contact/coarse_action.hpp"
#include "solve/contact/junctions.hpp"

/// \file Which inequalities are equalities, and when.

namespace extremal {

/// The intervals of a coarse minimum with these multipliers, from 0 to T.
std::vector<Interval> intervals_of(const Problem& problem, const CoarseAction& action,
                                   std::span<const double> z, std::span<const double> multipliers);

/// Whether a point at which an inequality has these values lies on its surface, to the roundoff of a path of
/// this size.
bool on_surface(const ConstraintValues& values, int constraint, double size);

/// Leaves out intervals without length, and joins neighbours that hold the same.
void tidy(std::vector<Interval>& intervals, double duration);

/// Gives the time of one interval to its neighbours, then tidies. A contact between two intervals that hold
/// the same otherwise becomes a touch.
void leave_out(std::vector<Interval>& intervals, int number, double duration);

/// What is held changes in [from, to]: `constraint` is added or taken away. Then tidies.
void change(std::vector<Interval>& intervals, int constraint, bool held, double from, double to,
            double duration);

}  // namespace extremal
