#pragma once

#include <string>

#include "solve/adapt/options.hpp"
#include "solve/bordered/bordered_equations.hpp"
#include "solve/bordered/found.hpp"

/// \file Whether a state is a solution, and its properties.

namespace extremal {

/// Why a path on which forces do not balance is none.
std::string residual_remains(double residual);

/// What else is known of a path that is judged.
struct Measured {
  double error;  ///< of q, absolute
  /// Its dense output, where polynomials of higher degree (recovery.hpp) are better than its own.
  const Path* recovered = nullptr;
};

/// A state where Newton's method has converged, as a solution, or why it is none.
Solution judge(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
               const Found& found, const Measured& measured);

}  // namespace extremal
