#pragma once

#include <string>

#include "solve/adapt/options.hpp"
#include "solve/bordered/bordered_equations.hpp"

/// \file Whether a state is a solution, and its properties.

namespace extremal {

/// Why a path on which forces do not balance is none.
std::string residual_remains(double residual);

/// A state where Newton's method has converged, as a solution, or why it is none. `error` is that of q,
/// absolute; `first` the size of the path that it began from.
Solution judge(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
               const BorderedState& state, const ElementTables& tables, double error, double first);

}  // namespace extremal
