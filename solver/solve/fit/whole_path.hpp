#pragma once

#include <optional>
#include <vector>

#include "solve/fit/fit.hpp"

/// \file A first extremal for a fit, where the first values of its unknowns have none.

namespace extremal {

/// What a fit may begin with: values of its unknowns, and an extremal for them.
struct FirstFit {
  std::vector<double> values;
  Guess guess;  ///< the extremal, at the nodes of its elements
  double duration = 0;
  int iterations = 0;
};

/// Path and unknowns are found together, from the guess of the task, which need not be an extremal: the
/// method of Gauss and Newton with the equations of motion as linear conditions of each step (Bock, Recent
/// Advances in Parameter Identification Techniques for O.D.E., 1983). With K the second variation and r the
/// residuals, the step of the path is −K⁻¹ δS_h + Σ_j y_j ∂z/∂θ_j, and y makes the linearised residuals
/// least. Data hold the path from the first step on, so that ends beyond which no extremal leads for the
/// first values do no harm. Nothing where the steps do not shrink.
std::optional<FirstFit> fit_whole_path(const FitTask& task, const SolveOptions& options);

}  // namespace extremal
