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

/// From any address.
static inline Vec load_eight(const double* p) {
  Vec value;
  __builtin_memcpy(&value, p, sizeof value);
  return value;
}

/// Every second entry of a and b, of the even or of the odd ones; every second pair; halves.
static inline Vec even_entries(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{0, 8, 2, 10, 4, 12, 6, 14});
}
static inline Vec odd_entries(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{1, 9, 3, 11, 5, 13, 7, 15});
}
static inline Vec even_pairs(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{0, 1, 8, 9, 4, 5, 12, 13});
}
static inline Vec odd_pairs(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{2, 3, 10, 11, 6, 7, 14, 15});
}
static inline Vec first_halves(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{0, 1, 2, 3, 8, 9, 10, 11});
}
static inline Vec last_halves(const Vec& a, const Vec& b) {
  return __builtin_shuffle(a, b, Mask{4, 5, 6, 7, 12, 13, 14, 15});
}

/// Eight rows of eight become columns.
static inline void transpose(Vec* row) {
  Vec pair[8], four[8];
  for (int i = 0; i < 8; i += 2) {
    pair[i] = even_entries(row[i], row[i + 1]);
    pair[i + 1] = odd_entries(row[i], row[i + 1]);
  }
  for (int i = 0; i < 8; i += 4)
    for (int k = 0; k < 2; ++k) {
      four[i + k] = even_pairs(pair[i + k], pair[i + k + 2]);
      four[i + k + 2] = odd_pairs(pair[i + k], pair[i + k + 2]);
    }
  for (int k = 0; k < 4; ++k) {
    row[k] = first_halves(four[k], four[k + 4]);
    row[k + 4] = last_halves(four[k], four[k + 4]);
  }
}

}  // namespace extremal::EXTREMAL_LEVEL
