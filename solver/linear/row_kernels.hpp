#pragma once

#include "machine/lanes.hpp"

/// \file For kernels: sums over rows that are padded to whole vectors.

namespace extremal::EXTREMAL_LEVEL {

static constexpr int tile = 4;

static inline double magnitude(double x) { return __builtin_fabs(x); }
static inline double larger(double a, double b) { return a > b ? a : b; }
/// Rows and columns are padded to whole vectors and to whole tiles.
static constexpr int padding = lanes > tile ? lanes : tile;
static inline int padded(int n) { return (n + padding - 1) & -padding; }

/// Σ |x_i|.
static inline double sum(const double* x, int count) {
  Vec part[2] = {};
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes)
    for (int k = 0; k < 2; ++k) {
      const Vec y = load(x + i + lanes * k);
      part[k] += y < 0 ? -y : y;
    }
  double s = 0;
  for (; i < count; ++i) s += magnitude(x[i]);
  part[0] += part[1];
  for (int k = 0; k < lanes; ++k) s += part[0][k];
  return s;
}

/// Four rows of `to`, `across` doubles from row to row, `vectors` × lanes columns:
/// to −= Σ_{p < count} v[p][0..3] w[p].
template <int vectors>
static inline void take(double* to, long across, const double* v, const double* w, int count, int stride) {
  Vec sum[tile][vectors];
  for (int i = 0; i < tile; ++i)
    for (int c = 0; c < vectors; ++c) sum[i][c] = at(to + i * across + lanes * c);
  for (int p = 0; p < count; ++p, v += stride, w += stride)
    for (int c = 0; c < vectors; ++c) {
      const Vec row = at(w + lanes * c);
      for (int i = 0; i < tile; ++i) sum[i][c] -= v[i] * row;
    }
  for (int i = 0; i < tile; ++i)
    for (int c = 0; c < vectors; ++c) at(to + i * across + lanes * c) = sum[i][c];
}

/// The same over the columns from `begin` to `end`, multiples of the lanes.
static inline void take_rows(double* to, long across, const double* v, const double* w, int count, int stride,
                             int begin, int end) {
  int c = begin;
  for (; c + 2 * lanes <= end; c += 2 * lanes) take<2>(to + c, across, v, w + c, count, stride);
  if (c < end) take<1>(to + c, across, v, w + c, count, stride);
}

static inline double dot(const double* a, const double* b, int count) {
  Vec sums = {};
  int i = 0;
  for (; i + lanes <= count; i += lanes) sums += load(a + i) * load(b + i);
  double s = 0;
  for (; i < count; ++i) s += a[i] * b[i];
  for (int j = 0; j < lanes; ++j) s += sums[j];
  return s;
}

static inline void subtract(double* __restrict to, const double* __restrict v, double y, int count) {
  for (int i = 0; i < count; ++i) to[i] -= y * v[i];
}

}  // namespace extremal::EXTREMAL_LEVEL
