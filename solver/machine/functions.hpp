#pragma once

#include <immintrin.h>
#include <sleef.h>

#include "machine/lanes.hpp"

/// \file For kernels (*.simd.cpp) only: elementary functions of a batch. Square roots are correctly
/// rounded; the others are SLEEF's, accurate to 1 ulp.

namespace extremal::EXTREMAL_LEVEL {

#if defined(__AVX512F__)
typedef __m512d Register;
#define EXTREMAL_SLEEF(name, accuracy) Sleef_##name##d8_##accuracy##avx512f
// With a mask of all lanes: the plain form draws a false warning from g++ 12.
static inline Register root_of(Register x) { return _mm512_maskz_sqrt_pd(0xff, x); }
#elif defined(__AVX2__)
typedef __m256d Register;
#define EXTREMAL_SLEEF(name, accuracy) Sleef_##name##d4_##accuracy##avx2
static inline Register root_of(Register x) { return _mm256_sqrt_pd(x); }
#else
typedef __m128d Register;
#define EXTREMAL_SLEEF(name, accuracy) Sleef_##name##d2_##accuracy##sse2
static inline Register root_of(Register x) { return _mm_sqrt_pd(x); }
#endif

/// A batch as the registers of the level.
union Pack {
  Vec vec;
  Register part[sizeof(Vec) / sizeof(Register)];
};

template <class Function>
static inline Vec each(Vec x, Function function) {
  Pack p{x};
#pragma GCC unroll 4
  for (Register& r : p.part) r = function(r);
  return p.vec;
}

template <class Function>
static inline Vec each(Vec x, Vec y, Function function) {
  Pack p{x}, q{y};
#pragma GCC unroll 4
  for (unsigned k = 0; k < sizeof(Vec) / sizeof(Register); ++k) p.part[k] = function(p.part[k], q.part[k]);
  return p.vec;
}

static inline Vec sqrt(Vec x) { return each(x, root_of); }
static inline Vec sin(Vec x) { return each(x, EXTREMAL_SLEEF(sin, u10)); }
static inline Vec cos(Vec x) { return each(x, EXTREMAL_SLEEF(cos, u10)); }
static inline Vec tan(Vec x) { return each(x, EXTREMAL_SLEEF(tan, u10)); }
static inline Vec asin(Vec x) { return each(x, EXTREMAL_SLEEF(asin, u10)); }
static inline Vec acos(Vec x) { return each(x, EXTREMAL_SLEEF(acos, u10)); }
static inline Vec atan(Vec x) { return each(x, EXTREMAL_SLEEF(atan, u10)); }
static inline Vec sinh(Vec x) { return each(x, EXTREMAL_SLEEF(sinh, u10)); }
static inline Vec cosh(Vec x) { return each(x, EXTREMAL_SLEEF(cosh, u10)); }
static inline Vec tanh(Vec x) { return each(x, EXTREMAL_SLEEF(tanh, u10)); }
static inline Vec exp(Vec x) { return each(x, EXTREMAL_SLEEF(exp, u10)); }
static inline Vec log(Vec x) { return each(x, EXTREMAL_SLEEF(log, u10)); }
static inline Vec pow(Vec x, Vec y) { return each(x, y, EXTREMAL_SLEEF(pow, u10)); }
static inline Vec atan2(Vec y, Vec x) { return each(y, x, EXTREMAL_SLEEF(atan2, u10)); }

static inline void sincos(Vec x, Vec& sine, Vec& cosine) {
  Pack p{x}, s, c;
#pragma GCC unroll 4
  for (unsigned k = 0; k < sizeof(Vec) / sizeof(Register); ++k) {
    const auto both = EXTREMAL_SLEEF(sincos, u10)(p.part[k]);
    s.part[k] = both.x;
    c.part[k] = both.y;
  }
  sine = s.vec;
  cosine = c.vec;
}

static inline Vec min(Vec x, Vec y) { return y < x ? y : x; }
static inline Vec max(Vec x, Vec y) { return x < y ? y : x; }
static inline Vec abs(Vec x) { return x < broadcast(0) ? -x : x; }
static inline Vec step(Vec x, Vec y) { return x >= y ? broadcast(1) : broadcast(0); }

}  // namespace extremal::EXTREMAL_LEVEL
