#pragma once

#include "action/path.hpp"
#include "problem/closing.hpp"

/// \file Periodic orbits begun later.

namespace extremal {

/// Fills `later` with a closed path begun at one of its nodes between elements, on elements of `tables`,
/// whose degree is the path's.
void begin_at(const ClosingMap& map, const Path& path, const ElementTables& tables, int node, Path& later);

}  // namespace extremal
