#pragma once

/// \file For kernels (*.simd.cpp) only: a vector register of doubles as one value. Everything here is a
/// language extension of g++ and clang or lives in the namespace of the level, so that nothing inline is
/// shared between levels.

#ifndef EXTREMAL_LEVEL
#error "lanes.hpp is for files named *.simd.cpp"
#endif

namespace extremal::EXTREMAL_LEVEL {

/// Doubles in a register: simd_lanes() of the level. A batch of elements or points has one in each lane.
#if defined(__AVX512F__)
static constexpr int lanes = 8;
#elif defined(__AVX__)
static constexpr int lanes = 4;
#else  // SSE2, NEON
static constexpr int lanes = 2;
#endif

typedef double Vec __attribute__((vector_size(8 * lanes), may_alias));
typedef long long Mask __attribute__((vector_size(8 * lanes), may_alias));

/// Other numbers of doubles as one value, up to a register.
template <int count>
struct Doubles {
  typedef double type __attribute__((vector_size(8 * count)));
};
template <>
struct Doubles<1> {
  typedef double type;
};

static inline Vec broadcast(double x) { return x - Vec{}; }
static inline Vec& at(double* p) { return *reinterpret_cast<Vec*>(p); }
static inline const Vec& at(const double* p) { return *reinterpret_cast<const Vec*>(p); }

/// From and to any address.
static inline Vec load(const double* p) {
  Vec value;
  __builtin_memcpy(&value, p, sizeof value);
  return value;
}
static inline void store(double* p, Vec value) { __builtin_memcpy(p, &value, sizeof value); }

/// Lane of [a, b] that goes to a lane of low<distance>(a, b) and of high<distance>(a, b).
static constexpr int low_lane(int distance, int lane) {
  return lane & distance ? lanes + lane - distance : lane;
}
static constexpr int high_lane(int distance, int lane) {
  return lane & distance ? lanes + lane : lane + distance;
}
#if defined(__AVX512F__)
#define EXTREMAL_SHUFFLE(a, b, from)                                                                        \
  __builtin_shufflevector(a, b, from(distance, 0), from(distance, 1), from(distance, 2), from(distance, 3), \
                          from(distance, 4), from(distance, 5), from(distance, 6), from(distance, 7))
#elif defined(__AVX__)
#define EXTREMAL_SHUFFLE(a, b, from) \
  __builtin_shufflevector(a, b, from(distance, 0), from(distance, 1), from(distance, 2), from(distance, 3))
#else
#define EXTREMAL_SHUFFLE(a, b, from) __builtin_shufflevector(a, b, from(distance, 0), from(distance, 1))
#endif

/// With lanes cut into blocks of `distance`: the even blocks of a and b, alternately; the odd ones.
template <int distance>
static inline Vec low(Vec a, Vec b) {
  return EXTREMAL_SHUFFLE(a, b, low_lane);
}
template <int distance>
static inline Vec high(Vec a, Vec b) {
  return EXTREMAL_SHUFFLE(a, b, high_lane);
}
#undef EXTREMAL_SHUFFLE

/// `lanes` rows become columns: blocks of 1, 2, … lanes change places with those on the other side of the
/// diagonal.
template <int distance = 1>
static inline void transpose(Vec* row) {
  for (int i = 0; i < lanes; ++i) {
    if (i & distance) continue;
    const Vec a = row[i], b = row[i + distance];
    row[i] = low<distance>(a, b);
    row[i + distance] = high<distance>(a, b);
  }
  if constexpr (2 * distance < lanes) transpose<2 * distance>(row);
}

/// The sums over the lanes of `lanes` vectors, which are overwritten.
template <int distance = 1>
static inline Vec sum_lanes(Vec* s) {
  for (int i = 0; i < lanes; i += 2 * distance)
    s[i] = low<distance>(s[i], s[i + distance]) + high<distance>(s[i], s[i + distance]);
  if constexpr (2 * distance < lanes)
    return sum_lanes<2 * distance>(s);
  else
    return s[0];
}

}  // namespace extremal::EXTREMAL_LEVEL
