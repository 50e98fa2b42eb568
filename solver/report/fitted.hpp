#pragma once

#include "report/result.hpp"
#include "study/fitting.hpp"

/// \file What a fit found, as results have it.

namespace extremal {

/// Of a fit that converged.
Fitted fitted_of(const FitRequest& request, const FitResult& fit);

}  // namespace extremal
