#pragma once

#include <vector>

#include "solve/contact/coarse_action.hpp"

/// \file Paths that lead through what is forbidden are moved out of it.

namespace extremal {

/// Moves nodes out of what is forbidden to one side of it: across the way on which the path passes through
/// it. False where some node stays.
bool move_aside(const Problem& problem, const CoarseAction& action, std::vector<double>& z);

/// Whether an element leads through something forbidden, rather than along a boundary that curves.
bool cuts_through(const Problem& problem, const CoarseAction& action, const std::vector<double>& z);

/// A direction across the line between the ends of a path; the same at every call.
Eigen::VectorXd across_line(const std::vector<double>& z, int n, unsigned number);

}  // namespace extremal
