#pragma once

/// \file For kernels (*.simd.cpp) only: a batch of eight doubles as one value. Everything here is a
/// language extension or lives in the namespace of the level, so that nothing inline is shared
/// between levels.

#ifndef EXTREMAL_LEVEL
#error "lanes.hpp is for files named *.simd.cpp"
#endif

namespace extremal::EXTREMAL_LEVEL {

typedef double Vec __attribute__((vector_size(64), aligned(64), may_alias));
typedef long long Mask __attribute__((vector_size(64), aligned(64), may_alias));

static inline Vec broadcast(double x) { return Vec{x, x, x, x, x, x, x, x}; }
static inline Vec& at(double* p) { return *reinterpret_cast<Vec*>(p); }
static inline const Vec& at(const double* p) { return *reinterpret_cast<const Vec*>(p); }

}  // namespace extremal::EXTREMAL_LEVEL
