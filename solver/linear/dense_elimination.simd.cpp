#include "linear/dense_elimination_kernels.hpp"
#include "linear/row_kernels.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// Pivots between two updates of what is left, and columns of the update that stay in the nearest cache.
constexpr int block = 64, strip = 64;

inline int least(int a, int b) { return a < b ? a : b; }
inline int most(int a, int b) { return a > b ? a : b; }

/// Elimination in progress; the first row of V belongs to pivot `first`.
struct DenseElimination {
  DenseEliminationShape s;
  double *m, *v, *size, *taken;
  DenseEliminationMonitor* monitor;

  double* row(int i) const { return m + long(i) * s.stride; }
  double* multipliers(int j, int first) const { return v + long(j - first) * s.stride; }

  /// Row i −= V[j][i] times row j.
  void take_one(int i, int j, int first) const {
    const double factor = multipliers(j, first)[i];
    double* const to = row(i);
    const double* const from = row(j);
    for (int c = i & -lanes; c < s.stride; c += lanes) at(to + c) -= factor * at(from + c);
  }

  bool pivot(int j, int first) const {
    double *const wj = row(j), *const vj = multipliers(j, first);
    const double d = wj[j], r = 1 / d;
    if (!(magnitude(d) > 0 && magnitude(r) > 0)) return false;
    ++(d > 0 ? monitor->positive : monitor->negative);
    monitor->cancellation = larger(monitor->cancellation, (size[j] + taken[j]) * magnitude(r));
    for (int c = j & -lanes; c < s.stride; c += lanes) {
      const Vec w = at(wj + c), factor = w * r, product = w * factor;
      at(vj + c) = factor;
      at(taken + c) += product < 0 ? -product : product;
    }
    return true;
  }

  /// The pivots of one block.
  bool panel(int first, int last) const {
    for (int from = first; from < last; from += tile) {
      const int to = least(from + tile, last);
      if (to == from + tile)
        take_rows(row(from), s.stride, v + from, row(first), from - first, s.stride, from & -lanes, s.stride);
      else
        for (int i = from; i < to; ++i)
          for (int j = first; j < from; ++j) take_one(i, j, first);
      for (int j = from; j < to; ++j) {
        if (!pivot(j, first)) return false;
        for (int i = j + 1; i < to; ++i) take_one(i, j, first);
      }
    }
    return true;
  }

  /// What the pivots of a block take from the upper triangle below it.
  void update(int first, int last) const {
    const int rows = s.half + s.rest;
    for (int c = last & -lanes; c < s.stride; c += strip) {
      const int end = least(c + strip, s.stride);
      for (int i = last; i < least(rows, end); i += tile)
        take_rows(row(i), s.stride, v + i, row(first), last - first, s.stride, most(c, i & -lanes), end);
    }
  }
};

bool eliminate(const DenseEliminationShape& shape, double* m, double* v, double* size, double* taken,
               DenseEliminationMonitor* monitor) {
  const DenseElimination e{shape, m, v, size, taken, monitor};
  for (int c = 0; c < shape.stride; ++c) taken[c] = 0;
  for (int j = 0; j < shape.pivots; ++j) size[j] = magnitude(e.row(j)[j]);
  for (int first = 0; first < shape.pivots; first += block) {
    const int last = least(first + block, shape.pivots);
    if (!e.panel(first, last)) return false;
    e.update(first, last);
  }
  return true;
}

/// A single column: a row of Lᵀ at a time is multiplied with it.
void substitute_one(const DenseEliminationShape& s, double* m, double* x) {
  for (int j = s.pivots - 1; j >= 0; --j) {
    double* const row = m + long(j) * s.stride;
    x[j] = row[s.half] = (row[s.half] - dot(row + j + 1, x + j + 1, s.pivots - j - 1)) / row[j];
  }
}

void substitute(const DenseEliminationShape& s, double* m, double* v) {
  if (s.rest == 1) return substitute_one(s, m, v);
  const auto row = [&](int i) { return m + long(i) * s.stride; };
  const int begin = s.half & -lanes;
  for (int first = (s.pivots - 1) / block * block; first >= 0; first -= block) {
    const int last = least(first + block, s.pivots);
    for (int j = last - 1; j >= first; --j) {
      double* const x = row(j);
      for (int k = j + 1; k < last; ++k)
        for (int c = begin; c < s.stride; c += lanes) at(x + c) -= x[k] * at(row(k) + c);
      const double r = 1 / x[j];
      for (int c = begin; c < s.stride; c += lanes) at(x + c) *= r;
    }
    for (int i = 0; i < first; ++i)
      for (int k = first; k < last; ++k) v[long(k - first) * s.stride + i] = row(i)[k];
    for (int c = begin; c < s.stride; c += strip)
      for (int i = 0; i < first; i += tile)
        take_rows(row(i), s.stride, v + i, row(first), last - first, s.stride, c, least(c + strip, s.stride));
  }
}

}  // namespace

DenseEliminationKernels dense_elimination_kernels() { return {padding, block, eliminate, substitute}; }

}  // namespace extremal::EXTREMAL_LEVEL
