#pragma once

#include "machine/lanes.hpp"

/// \file What the kernels of elements share.

namespace extremal::EXTREMAL_LEVEL {

/// Group k: one value for each element of the batch.
static inline const Vec& group(const double* p, long k) { return at(p + lanes * k); }
static inline Vec& group(double* p, long k) { return at(p + lanes * k); }

/// Elimination::scatter (elimination.hpp).
void scatter(const double* groups, int count, int used, bool add, double* const* to);

}  // namespace extremal::EXTREMAL_LEVEL
