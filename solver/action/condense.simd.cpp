#include "action/element_kernels.hpp"
#include "action/elimination.hpp"
#include "machine/lanes.hpp"

/// \file Elimination of the inner unknowns of a batch of elements, one in each lane.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// Σ_{from <= k < to} y_rk l_k of some rows.
template <int rows>
inline void products(const double* y, long stride, int from, int to, const double* l, Vec* sum) {
  for (int r = 0; r < rows; ++r) sum[r] = broadcast(0);
  for (int k = from; k < to; ++k) {
    const Vec factor = group(l, k);
    for (int r = 0; r < rows; ++r) sum[r] += group(y + r * stride * lanes, k) * factor;
  }
}

/// The same with the factors of two columns.
template <int rows>
inline void products(const double* y, long stride, int from, int to, const double* l0, const double* l1,
                     Vec* s0, Vec* s1) {
  for (int r = 0; r < rows; ++r) s0[r] = s1[r] = broadcast(0);
  for (int k = from; k < to; ++k) {
    const Vec a = group(l0, k), c = group(l1, k);
    for (int r = 0; r < rows; ++r) {
      const Vec x = group(y + r * stride * lanes, k);
      s0[r] += x * a;
      s1[r] += x * c;
    }
  }
}

/// Columns j and j + 1 of some rows below them, in the panel.
template <int rows>
inline void column_pair(double* y, int stride, int from, int j, const Vec& l10, const double* l0,
                        const double* l1) {
  Vec s0[rows], s1[rows];
  products<rows>(y, stride, from, j, l0, l1, s0, s1);
  for (int r = 0; r < rows; ++r) {
    double* row = y + static_cast<long>(r) * stride * lanes;
    const Vec first = group(row, j) - s0[r];
    group(row, j) = first;
    group(row, j + 1) -= s1[r] + first * l10;
  }
}

template <int rows>
inline void single_column(double* y, int stride, int from, int j, const double* l) {
  Vec sum[rows];
  products<rows>(y, stride, from, j, l, sum);
  for (int r = 0; r < rows; ++r) group(y + static_cast<long>(r) * stride * lanes, j) -= sum[r];
}

struct Monitor {
  Vec negative, shrunk;  ///< shrunk: largest ratio of a diagonal entry to the pivot that it became
  /// 1/d; `inverse` held the diagonal entry that d came from.
  void pivot(double* inverse, const Vec& d) {
    const Vec reciprocal = 1.0 / d, ratio = at(inverse) * reciprocal, size = ratio < 0 ? -ratio : ratio;
    at(inverse) = reciprocal;
    negative += d < 0 ? broadcast(1) : broadcast(0);
    shrunk = size > shrunk ? size : shrunk;
  }
};

/// Left-looking, two columns at a time; `rows` rows, those of the vectors among them.
void factor_panel(const FrontView& f, int rows, double* panel, double* inverse, Monitor& monitor,
                  double* work) {
  const int p = f.pivots;
  double *l0 = work, *l1 = work + static_cast<long>(p) * lanes;
  for (int j = 0; j < p; j += 2) {
    const bool pair = j + 1 < p;
    double* row0 = panel + static_cast<long>(j) * p * lanes;
    double* row1 = pair ? row0 + static_cast<long>(p) * lanes : row0;
    Vec s00 = broadcast(0), s10 = broadcast(0), s11 = broadcast(0);
    for (int k = 0; k < j; ++k) {
      const Vec y0 = group(row0, k), y1 = group(row1, k);
      const Vec a = y0 * group(inverse, k), c = y1 * group(inverse, k);
      group(l0, k) = a;
      group(l1, k) = c;
      s00 += y0 * a;
      s10 += y1 * a;
      s11 += y1 * c;
    }
    group(row0, j) -= s00;
    monitor.pivot(inverse + j * lanes, group(row0, j));
    Vec l10 = broadcast(0);
    if (pair) {
      const Vec y10 = group(row1, j) - s10;
      group(row1, j) = y10;
      l10 = y10 * group(inverse, j);
      group(row1, j + 1) -= s11 + y10 * l10;
      monitor.pivot(inverse + (j + 1) * lanes, group(row1, j + 1));
    }
    int i = j + 1 + pair;
    double* y = panel + static_cast<long>(i) * p * lanes;
    const auto from = [&] { return i < p ? 0 : f.start[i]; };
    if (!pair) {
      for (; i < rows; ++i, y += static_cast<long>(p) * lanes) single_column<1>(y, p, from(), j, l0);
      break;
    }
    for (; i + 4 <= rows; i += 4, y += 4L * p * lanes)
      if (from() <= j + 1) column_pair<4>(y, p, from(), j, l10, l0, l1);
    if (rows - i == 3) column_pair<3>(y, p, from(), j, l10, l0, l1);
    if (rows - i == 2) column_pair<2>(y, p, from(), j, l10, l0, l1);
    if (rows - i == 1) column_pair<1>(y, p, from(), j, l10, l0, l1);
  }
}

/// Takes rows i … i + rows − 1 times columns c and c + 1 from where they go.
template <int rows>
inline void take(const FrontView& f, const FrontTarget& t, const double* panel, int i, int c, int from,
                 const double* l0, const double* l1, double* matrix) {
  Vec s0[rows], s1[rows];
  products<rows>(panel + static_cast<long>(i) * f.pivots * lanes, f.pivots, from, f.pivots, l0, l1, s0, s1);
  const int *row = t.row + (i - t.begin), *column = t.column + (c - t.begin);
  for (int r = 0; r < rows; ++r) {
    group(matrix, row[r] + column[0]) -= s0[r];
    group(matrix, row[r] + column[1]) -= s1[r];
  }
}

/// What columns c and c + 1 of the rows below the pivots take from rows c … rows − 1.
void take_pair(const FrontView& f, const FrontTarget& t, int rows, const double* panel, const double* inverse,
               int c, double* matrix, double* work) {
  const int p = f.pivots, start = f.start[c];
  const double* const y = panel + static_cast<long>(c) * p * lanes;
  double *l0 = work, *l1 = work + static_cast<long>(p) * lanes;
  Vec s00 = broadcast(0), s10 = broadcast(0), s11 = broadcast(0);
  for (int k = start; k < p; ++k) {
    const Vec y0 = group(y, k), y1 = group(y, p + k), scale = group(inverse, k);
    const Vec a = y0 * scale, b = y1 * scale;
    group(l0, k) = a;
    group(l1, k) = b;
    s00 += y0 * a;
    s10 += y1 * a;
    s11 += y1 * b;
  }
  const int *row = t.row + (c - t.begin), *column = t.column + (c - t.begin);
  group(matrix, row[0] + column[0]) -= s00;
  group(matrix, row[1] + column[0]) -= s10;
  group(matrix, row[1] + column[1]) -= s11;
  int i = c + 2;
  const auto from = [&] { return start > f.start[i] ? start : f.start[i]; };
  for (; i + 4 <= rows; i += 4) take<4>(f, t, panel, i, c, from(), l0, l1, matrix);
  if (rows - i == 3) take<3>(f, t, panel, i, c, from(), l0, l1, matrix);
  if (rows - i == 2) take<2>(f, t, panel, i, c, from(), l0, l1, matrix);
  if (rows - i == 1) take<1>(f, t, panel, i, c, from(), l0, l1, matrix);
}

void take_single(const FrontView& f, const FrontTarget& t, int rows, const double* panel,
                 const double* inverse, int c, double* matrix, double* work) {
  const int p = f.pivots, start = f.start[c];
  for (int k = start; k < p; ++k)
    group(work, k) = group(panel, static_cast<long>(c) * p + k) * group(inverse, k);
  const int column = t.column[c - t.begin];
  for (int i = c; i < rows; ++i) {
    Vec sum[1];
    products<1>(panel + static_cast<long>(i) * p * lanes, p, start, p, work, sum);
    group(matrix, t.row[i - t.begin] + column) -= sum[0];
  }
}

inline void clear_triangle(double* matrix, int size, int rows) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < (i < size ? i + 1 : size); ++j)
      group(matrix, static_cast<long>(i) * size + j) = Vec{};
}

void clear(const FrontView* fronts, int front_count, double* matrix, int ends, int end_count) {
  for (int k = 0; k < front_count; ++k)
    clear_triangle(matrix + static_cast<long>(fronts[k].panel) * lanes, fronts[k].pivots, fronts[k].rows + 2);
  clear_triangle(matrix + static_cast<long>(ends) * lanes, end_count, end_count + 2);
}

void condense(const FrontView* fronts, int front_count, double* matrix, int ends, int end_count,
              double* vectors, int count, double* inverse, double* negative, double* ratio, double* work) {
  Monitor monitor{broadcast(0), broadcast(1)};
  int inner = 0;
  for (int k = 0; k < front_count; ++k) {
    const FrontView& f = fronts[k];
    inner += f.pivots;
    for (int j = 0; j < f.pivots; ++j)
      group(inverse, f.first + j) = group(matrix, f.panel + j * (f.pivots + 1));
  }
  const int m = inner + end_count;
  for (int k = 0; k < front_count; ++k) {
    const FrontView& f = fronts[k];
    double* panel = matrix + static_cast<long>(f.panel) * lanes;
    double* own = inverse + static_cast<long>(f.first) * lanes;
    double* last = panel + static_cast<long>(f.rows) * f.pivots * lanes;
    for (int v = 0; v < count; ++v)
      for (int j = 0; j < f.pivots; ++j)
        group(last, v * f.pivots + j) += group(vectors, v * m + f.unknown[j]);
    factor_panel(f, f.rows + count, panel, own, monitor, work);
    for (int v = 0; v < count; ++v)
      for (int j = 0; j < f.pivots; ++j) group(vectors, v * m + f.unknown[j]) = group(last, v * f.pivots + j);
    for (int t = 0; t < f.targets; ++t) {
      const FrontTarget& target = f.target[t];
      int c = target.begin;
      for (; c + 1 < target.end; c += 2) take_pair(f, target, f.rows + count, panel, own, c, matrix, work);
      if (c < target.end) take_single(f, target, f.rows + count, panel, own, c, matrix, work);
    }
  }
  const double* last = matrix + (ends + static_cast<long>(end_count) * end_count) * lanes;
  for (int v = 0; v < count; ++v)
    for (int e = 0; e < end_count; ++e) group(vectors, v * m + inner + e) += group(last, v * end_count + e);
  at(negative) = monitor.negative;
  at(ratio) = 1.0 / monitor.shrunk;
}

/// g_i −= Σ y_ik t_k of some rows.
template <int rows>
inline void reduce_rows(const double* y, int p, int from, const int* unknown, const double* scaled,
                        double* gradient) {
  Vec sum[rows];
  products<rows>(y, p, from, p, scaled, sum);
  for (int r = 0; r < rows; ++r) group(gradient, unknown[r]) -= sum[r];
}

void reduce(const FrontView* fronts, int front_count, const double* matrix, const double* inverse,
            double* gradient, double* work) {
  for (int k = 0; k < front_count; ++k) {
    const FrontView& f = fronts[k];
    const int p = f.pivots;
    const double* panel = matrix + static_cast<long>(f.panel) * lanes;
    for (int j = 0; j < p; ++j) {
      const double* row = panel + static_cast<long>(j) * p * lanes;
      Vec s0 = group(gradient, f.unknown[j]), s1 = broadcast(0);
      int i = j & 1;
      if (i) s1 = group(work, 0) * group(row, 0);
      for (; i < j; i += 2) {
        s1 += group(work, i) * group(row, i);
        s0 -= group(work, i + 1) * group(row, i + 1);
      }
      s0 -= s1;
      group(gradient, f.unknown[j]) = s0;
      group(work, j) = s0 * group(inverse, f.first + j);
    }
    for (int i = p; i < f.rows; i += 4) {
      const double* y = panel + static_cast<long>(i) * p * lanes;
      const int left = f.rows - i, from = f.start[i];
      const int* unknown = f.unknown + i;
      left >= 4   ? reduce_rows<4>(y, p, from, unknown, work, gradient)
      : left == 3 ? reduce_rows<3>(y, p, from, unknown, work, gradient)
      : left == 2 ? reduce_rows<2>(y, p, from, unknown, work, gradient)
                  : reduce_rows<1>(y, p, from, unknown, work, gradient);
    }
  }
}

/// The steps of pivots j … j + count − 1 of a front, from those of the rows below. The latest x last, so that
/// the chain of dependent sums is short.
template <int count>
inline void expand_pivots(const FrontView& f, int j, const double* panel, const double* inverse,
                          const double* gradient, const double* border, const Vec& step_h, double* x) {
  const double* y = panel + static_cast<long>(j) * lanes;
  const long stride = static_cast<long>(f.pivots) * lanes;
  Vec sum[count];
  for (int k = 0; k < count; ++k) sum[k] = broadcast(0);
  for (int i = f.rows - 1; i >= j + count; --i) {
    if (i >= f.pivots && f.start[i] >= j + count) continue;
    const Vec value = group(x, f.unknown[i]);
    for (int k = 0; k < count; ++k) sum[k] += group(y + i * stride, k) * value;
  }
  for (int k = 0; k < count; ++k) {
    sum[k] += group(gradient, f.unknown[j + k]);
    if (border) sum[k] += group(border, f.unknown[j + k]) * step_h;
  }
  for (int k = count - 1; k >= 0; --k) {
    const Vec value = -group(inverse, j + k) * sum[k];
    group(x, f.unknown[j + k]) = value;
    for (int q = 0; q < k; ++q) sum[q] += group(y + (j + k) * stride, q) * value;
  }
}

void expand_step(const FrontView* fronts, int front_count, const double* matrix, const double* inverse,
                 const double* gradient, const double* border, const double* step_h, double* x) {
  for (int k = front_count - 1; k >= 0; --k) {
    const FrontView& f = fronts[k];
    const double* panel = matrix + static_cast<long>(f.panel) * lanes;
    const double* own = inverse + static_cast<long>(f.first) * lanes;
    int j = f.pivots;
    for (; j >= 4; j -= 4) expand_pivots<4>(f, j - 4, panel, own, gradient, border, at(step_h), x);
    if (j == 3) expand_pivots<3>(f, 0, panel, own, gradient, border, at(step_h), x);
    if (j == 2) expand_pivots<2>(f, 0, panel, own, gradient, border, at(step_h), x);
    if (j == 1) expand_pivots<1>(f, 0, panel, own, gradient, border, at(step_h), x);
  }
}

}  // namespace

Elimination elimination_kernels() { return {clear, condense, reduce, expand_step, scatter}; }

}  // namespace extremal::EXTREMAL_LEVEL
