#pragma once

#include <optional>
#include <vector>

#include "solve/newton/iteration.hpp"

/// \file The family of an extremal: others for the same values of the unknowns of a fit.

namespace extremal {

/// Steps to other closed paths of the same action: a shift in time, and symmetries. Independent, and as long
/// as the path is wide. Of two copies both move alike.
std::vector<Step> moves_of_closed_path(const Problem& problem, const Path& path, const ElementTables& tables);

/// The step of that length along which the second variation of an extremal is softest, across those that are
/// known. `eigenvalue` is relative to the diagonal.
struct SoftStep {
  Step step;
  double eigenvalue = 0;
};
std::optional<SoftStep> softest_step(NewtonIteration& newton, const Path& path, const ElementTables& tables,
                                     const std::vector<Step>& known);

}  // namespace extremal
