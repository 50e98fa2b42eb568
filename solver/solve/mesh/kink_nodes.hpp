#pragma once

#include <optional>
#include <vector>

#include "action/path.hpp"
#include "action/tables.hpp"

/// \file Elements that end where a path crosses the surfaces on which L is not smooth.

namespace extremal {

/// The crossings, in t/T, ascending; empty where L is smooth. A closed path may cross where it closes: so
/// near 0 and T no element ends for it, unless that is farther than `beside` from T.
std::vector<double> kink_times(const ElementTables& tables, const Path& path, bool closed, double beside = 1);

/// The mesh of the path with these crossings as nodes, and none of those for which no element ends; nothing
/// where it is so, to `tolerance` of T, and where L is smooth. Of a closed path elements end also for
/// crossings farther than `beside` from T, in t/T.
std::optional<std::vector<double>> mesh_to_kinks(const ElementTables& tables, const Path& path, bool closed,
                                                 double tolerance, double beside = 1);

/// How far from T, in t/T, elements of a closed path that is known can end at crossings: not where it crosses
/// at T itself, or where roundings of q in so short an element would hide q'.
double least_beside_closing(int degree, double tolerance);

}  // namespace extremal
