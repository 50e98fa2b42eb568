#include "action/element_kernels.hpp"
#include "action/elimination.hpp"
#include "machine/lanes.hpp"

/// \file Elimination of the inner unknowns of eight elements side by side.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// Σ_{from <= k < to} y_rk l_ck of some rows r and one or two columns c.
template <int rows, int columns>
inline void products(const double* y, long stride, int from, int to, const double* const* l,
                     Vec (*sum)[columns]) {
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) sum[r][c] = broadcast(0);
  for (int k = from; k < to; ++k) {
    Vec factor[columns];
    for (int c = 0; c < columns; ++c) factor[c] = group(l[c], k);
    for (int r = 0; r < rows; ++r) {
      const Vec x = group(y, r * stride + k);
      for (int c = 0; c < columns; ++c) sum[r][c] += x * factor[c];
    }
  }
}

/// Columns j and j + 1 of some rows below them, in the panel.
template <int rows>
inline void column_pair(double* y, int stride, int from, int j, const Vec& l10, const double* const* l) {
  Vec sum[rows][2];
  products<rows, 2>(y, stride, from, j, l, sum);
  for (int r = 0; r < rows; ++r) {
    const Vec first = group(y, r * stride + j) - sum[r][0];
    group(y, r * stride + j) = first;
    group(y, r * stride + j + 1) -= sum[r][1] + first * l10;
  }
}

template <int rows>
inline void single_column(double* y, int stride, int from, int j, const double* const* l) {
  Vec sum[rows][1];
  products<rows, 1>(y, stride, from, j, l, sum);
  for (int r = 0; r < rows; ++r) group(y, r * stride + j) -= sum[r][0];
}

struct Monitor {
  Vec negative, least;
  /// 1/d; `inverse` held the diagonal entry that d came from.
  void pivot(double* inverse, const Vec& d) {
    const Vec before = at(inverse);
    at(inverse) = 1.0 / d;
    const Vec relative = (d < 0 ? -d : d) / (before < 0 ? -before : before);
    negative += d < 0 ? broadcast(1) : broadcast(0);
    least = relative < least ? relative : least;
  }
};

/// Left-looking, two columns at a time; `rows` rows, those of the vectors among them.
void factor_panel(const FrontView& f, int rows, double* panel, double* inverse, Monitor& monitor,
                  double* work) {
  const int p = f.pivots;
  double *l0 = work, *l1 = work + static_cast<long>(p) * lanes;
  const double* const l[2] = {l0, l1};
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
    for (int i = j + 1 + pair; i < rows; i += 4) {
      const int from = i < p ? 0 : f.start[i];
      if (from > j + 1) continue;
      double* y = panel + static_cast<long>(i) * p * lanes;
      const int left = rows - i;
      if (!pair)
        left >= 4   ? single_column<4>(y, p, from, j, l)
        : left == 3 ? single_column<3>(y, p, from, j, l)
        : left == 2 ? single_column<2>(y, p, from, j, l)
                    : single_column<1>(y, p, from, j, l);
      else
        left >= 4   ? column_pair<4>(y, p, from, j, l10, l)
        : left == 3 ? column_pair<3>(y, p, from, j, l10, l)
        : left == 2 ? column_pair<2>(y, p, from, j, l10, l)
                    : column_pair<1>(y, p, from, j, l10, l);
    }
  }
}

/// Takes rows i … i + rows − 1 times columns c (and c + 1) from where they go.
template <int rows, int columns>
inline void take(const FrontView& f, const FrontTarget& t, const double* panel, int i, int c, int from,
                 const double* const* l, double* matrix) {
  Vec sum[rows][columns];
  products<rows, columns>(panel + static_cast<long>(i) * f.pivots * lanes, f.pivots, from, f.pivots, l, sum);
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < columns; ++k)
      group(matrix, t.row[i + r - t.begin] + t.column[c + k - t.begin]) -= sum[r][k];
}

template <int columns>
inline void take_columns(const FrontView& f, const FrontTarget& t, const double* panel, const double* inverse,
                         int c, double* matrix, double* vectors, int count, int m, double* work) {
  const int p = f.pivots;
  const double* l[columns];
  const int start = f.start[c];
  for (int k = 0; k < columns; ++k) {
    const double* y = panel + static_cast<long>(c + k) * p * lanes;
    double* scaled = work + static_cast<long>(k) * p * lanes;
    for (int j = start; j < p; ++j) group(scaled, j) = group(y, j) * group(inverse, j);
    l[k] = scaled;
  }
  if (columns == 2) take<1, 1>(f, t, panel, c, c, start, l, matrix);
  for (int i = c + columns - 1; i < f.rows; i += 4) {
    const int from = start > f.start[i] ? start : f.start[i], left = f.rows - i;
    left >= 4   ? take<4, columns>(f, t, panel, i, c, from, l, matrix)
    : left == 3 ? take<3, columns>(f, t, panel, i, c, from, l, matrix)
    : left == 2 ? take<2, columns>(f, t, panel, i, c, from, l, matrix)
                : take<1, columns>(f, t, panel, i, c, from, l, matrix);
  }
  for (int v = 0; v < count; ++v) {
    Vec sum[1][columns];
    products<1, columns>(panel + static_cast<long>(f.rows + v) * p * lanes, p, start, p, l, sum);
    for (int k = 0; k < columns; ++k) group(vectors, v * m + f.unknown[c + k]) -= sum[0][k];
  }
}

void condense(const FrontView* fronts, int front_count, int m, double* matrix, double* vectors, int count,
              double* inverse, double* negative, double* ratio, double* work) {
  Monitor monitor{broadcast(0), broadcast(1)};
  for (int k = 0; k < front_count; ++k) {
    const FrontView& f = fronts[k];
    for (int j = 0; j < f.pivots; ++j)
      group(inverse, f.first + j) = group(matrix, f.panel + j * (f.pivots + 1));
  }
  for (int k = 0; k < front_count; ++k) {
    const FrontView& f = fronts[k];
    double* panel = matrix + static_cast<long>(f.panel) * lanes;
    double* own = inverse + static_cast<long>(f.first) * lanes;
    double* last = panel + static_cast<long>(f.rows) * f.pivots * lanes;
    for (int v = 0; v < count; ++v)
      for (int j = 0; j < f.pivots; ++j) group(last, v * f.pivots + j) = group(vectors, v * m + f.unknown[j]);
    factor_panel(f, f.rows + count, panel, own, monitor, work);
    for (int v = 0; v < count; ++v)
      for (int j = 0; j < f.pivots; ++j) group(vectors, v * m + f.unknown[j]) = group(last, v * f.pivots + j);
    for (int t = 0; t < f.targets; ++t) {
      const FrontTarget& target = f.target[t];
      int c = target.begin;
      for (; c + 1 < target.end; c += 2)
        take_columns<2>(f, target, panel, own, c, matrix, vectors, count, m, work);
      if (c < target.end) take_columns<1>(f, target, panel, own, c, matrix, vectors, count, m, work);
    }
  }
  at(negative) = monitor.negative;
  at(ratio) = monitor.least;
}

/// g_i −= Σ y_ik t_k of some rows.
template <int rows>
inline void reduce_rows(const double* y, int p, int from, const int* unknown, const double* scaled,
                        double* gradient) {
  Vec sum[rows][1];
  products<rows, 1>(y, p, from, p, &scaled, sum);
  for (int r = 0; r < rows; ++r) group(gradient, unknown[r]) -= sum[r][0];
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
  for (int k = 0; k < count; ++k) {
    sum[k] = group(gradient, f.unknown[j + k]);
    if (border) sum[k] += group(border, f.unknown[j + k]) * step_h;
  }
  for (int i = f.rows - 1; i >= j + count; --i) {
    if (i >= f.pivots && f.start[i] >= j + count) continue;
    const Vec value = group(x, f.unknown[i]);
    for (int k = 0; k < count; ++k) sum[k] += group(y + i * stride, k) * value;
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

extern const Elimination elimination;
const Elimination elimination = {condense, reduce, expand_step};

}  // namespace extremal::EXTREMAL_LEVEL
