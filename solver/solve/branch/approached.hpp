#pragma once

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file What the paths of a branch approach: equilibria, next to which the period diverges, or
/// singularities.

namespace extremal {

/// Longest element over shortest.
double grading(const Path& path);

/// The share of the duration in which the path hardly moves.
double share_at_rest(const Path& path);

/// Whether the path, where it is slowest, passes an equilibrium that motions approach and leave, at `rate`
/// (e-folds per time) or faster. True as well where linear motions beside it are not known.
bool passes_saddle(const Problem& problem, const Path& path, double rate);

/// Whether forces, where they are largest, change e-fold on a small part of the way, and elements are graded
/// accordingly.
bool near_singularity(const Problem& problem, const Path& path);

}  // namespace extremal
