#pragma once

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif
#include <sleef.h>

#include "machine/lanes.hpp"

/// \file For kernels (*.simd.cpp) only: elementary functions of a vector. Square roots are correctly
/// rounded; the others are SLEEF's, accurate to 1 ulp.

namespace extremal::EXTREMAL_LEVEL {

#if defined(__AVX512F__)
#define EXTREMAL_SLEEF(name) Sleef_##name##d8_u10avx512f
// With a mask of all lanes: the plain form draws a false warning from g++ 12.
static inline Vec sqrt(Vec x) { return _mm512_maskz_sqrt_pd(0xff, x); }
#elif defined(__AVX2__)
#define EXTREMAL_SLEEF(name) Sleef_##name##d4_u10avx2
static inline Vec sqrt(Vec x) { return _mm256_sqrt_pd(x); }
#elif defined(__SSE2__)
#define EXTREMAL_SLEEF(name) Sleef_##name##d2_u10sse2
static inline Vec sqrt(Vec x) { return _mm_sqrt_pd(x); }
#else
#define EXTREMAL_SLEEF(name) Sleef_##name##d2_u10advsimd
static inline Vec sqrt(Vec x) { return vsqrtq_f64(x); }
#endif

static inline Vec sin(Vec x) { return EXTREMAL_SLEEF(sin)(x); }
static inline Vec cos(Vec x) { return EXTREMAL_SLEEF(cos)(x); }
static inline Vec tan(Vec x) { return EXTREMAL_SLEEF(tan)(x); }
static inline Vec asin(Vec x) { return EXTREMAL_SLEEF(asin)(x); }
static inline Vec acos(Vec x) { return EXTREMAL_SLEEF(acos)(x); }
static inline Vec atan(Vec x) { return EXTREMAL_SLEEF(atan)(x); }
static inline Vec sinh(Vec x) { return EXTREMAL_SLEEF(sinh)(x); }
static inline Vec cosh(Vec x) { return EXTREMAL_SLEEF(cosh)(x); }
static inline Vec tanh(Vec x) { return EXTREMAL_SLEEF(tanh)(x); }
static inline Vec exp(Vec x) { return EXTREMAL_SLEEF(exp)(x); }
static inline Vec log(Vec x) { return EXTREMAL_SLEEF(log)(x); }
static inline Vec pow(Vec x, Vec y) { return EXTREMAL_SLEEF(pow)(x, y); }
static inline Vec atan2(Vec y, Vec x) { return EXTREMAL_SLEEF(atan2)(y, x); }

static inline void sincos(Vec x, Vec& sine, Vec& cosine) {
  const auto both = EXTREMAL_SLEEF(sincos)(x);
  sine = both.x;
  cosine = both.y;
}

static inline Vec min(Vec x, Vec y) { return y < x ? y : x; }
static inline Vec max(Vec x, Vec y) { return x < y ? y : x; }
static inline Vec abs(Vec x) { return x < broadcast(0) ? -x : x; }
static inline Vec step(Vec x, Vec y) { return x >= y ? broadcast(1) : broadcast(0); }

}  // namespace extremal::EXTREMAL_LEVEL
