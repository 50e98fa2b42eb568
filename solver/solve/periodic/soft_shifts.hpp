#pragma once

#include "solve/periodic/phase.hpp"

/// \file Paths that rest near equilibria: what lies between two rests can be shifted in time, and the action
/// changes by no more than the squared speed there.

namespace extremal {

/// Adds a direction for each part of the path between two times of rest, as PhaseConditions has them: q' of
/// that part. An end at which the path does not rest is none. Nothing where L depends on t.
void add_soft_shifts(const Problem& problem, const Path& path, const SchemeTables& scheme,
                     PhaseConditions& phases);

}  // namespace extremal
