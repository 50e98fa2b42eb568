#pragma once

#include "action/path.hpp"
#include "problem/closing.hpp"
#include "problem/problem.hpp"

/// \file Periodic orbits run through twice.

namespace extremal {

/// The problem of twice the period, which every solution of a periodic problem solves, run through twice. L
/// repeats after it as well. Symmetries are those of the problem: there may be more.
Problem doubled(const Problem& problem);

/// Fills `twice` with a path of the problem run through twice, on elements of `tables`, whose degree is the
/// path's.
void double_path(const Problem& problem, const Path& path, const ElementTables& tables, Path& twice);

}  // namespace extremal
