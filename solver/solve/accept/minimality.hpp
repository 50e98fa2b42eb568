#pragma once

#include "analysis/windows.hpp"
#include "solve/adapt/options.hpp"

/// \file Windows and conjugate times of a solution, from its second variation with fixed ends.

namespace extremal {

/// Sets windows, conjugate times and certificate of a converged solution. Returns how far T is from a time
/// conjugate to 0, about; infinite where none is near, or where it is not known. `memory` is kept between
/// solves.
double read_minimality(const Problem& problem, const SolveOptions& options, SecondVariation& memory,
                       Solution& solution);

}  // namespace extremal
