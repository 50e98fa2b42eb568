#pragma once

#include "analysis/windows.hpp"
#include "solve/adapt/options.hpp"
#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Windows and conjugate times of a solution, from its second variation with fixed ends.

namespace extremal {

/// The elements of a path that a user named, with their trajectory.
struct OwnElements {
  const Path& path;
  const ElementTables& tables;
  const Trajectory& trajectory;
};

/// Sets windows, conjugate times and certificate of a converged solution. Returns how far T is from a time
/// conjugate to 0, about; infinite where none is near, or where it is not known. `memory` is kept between
/// solves. With `own` the second variation is that of these elements; if a single one is not positive
/// definite, it is that along the trajectory.
double read_minimality(const Problem& problem, const SolveOptions& options, SecondVariation& memory,
                       Solution& solution, const OwnElements* own = nullptr);

/// Sets the index by a quadrature with more points, where ∂²L/∂q'∂q' vanishes at an open end: of products
/// η η', which are left of a total derivative there, the elements' own misses more than the mass gives.
void read_index_at_open_end(const Problem& problem, const Path& path, const Outcome& outcome, Workspace& w,
                            Solution& solution);

/// Takes the index away, with a word why, unless finer elements have the same one: where elements do not
/// resolve the second variation, its negative eigenvalues are those that they have room for.
void confirm_index(const Problem& problem, const Path& path, const Outcome& outcome, Workspace& w,
                   Solution& solution);

}  // namespace extremal
