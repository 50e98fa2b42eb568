#pragma once

#include "solve/adapt/options.hpp"
#include "solve/bordered/bordered_equations.hpp"

/// \file Whether a state is a solution, and its properties.

namespace extremal {

/// A state where Newton's method has converged, as a solution, or why it is none. `error` is that of q,
/// absolute; `first` the size of the path that it began from.
Solution judge(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
               const BorderedState& state, const ElementTables& tables, double error, double first);

}  // namespace extremal
