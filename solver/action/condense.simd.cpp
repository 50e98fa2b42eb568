#include "action/element_kernels.hpp"
#include "machine/lanes.hpp"

/// \file Elimination of the inner unknowns of eight elements side by side.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// A tile of four rows and two columns of A − Y Lᵀ over `depth` eliminated columns.
template <int rows>
inline void tile(const double* y, long m, int depth, const double* l0, const double* l1, Vec* s0, Vec* s1) {
  for (int r = 0; r < rows; ++r) s0[r] = s1[r] = broadcast(0);
  for (int k = 0; k < depth; ++k) {
    const Vec a = group(l0, k), c = group(l1, k);
    for (int r = 0; r < rows; ++r) {
      const Vec x = group(y + r * m * lanes, k);
      s0[r] += x * a;
      s1[r] += x * c;
    }
  }
}

/// Columns j and j + 1 of `rows` rows from row i on; both > j + 1.
template <int rows>
inline void column_pair(double* matrix, int m, int i, int j, int depth, bool eliminate, const Vec& l10,
                        const double* l0, const double* l1) {
  Vec s0[rows], s1[rows];
  double* y = matrix + static_cast<long>(i) * m * lanes;
  tile<rows>(y, m, depth, l0, l1, s0, s1);
  for (int r = 0; r < rows; ++r) {
    double* row = y + static_cast<long>(r) * m * lanes;
    const Vec first = group(row, j) - s0[r];
    group(row, j) = first;
    Vec second = group(row, j + 1) - s1[r];
    if (eliminate) second -= first * l10;
    group(row, j + 1) = second;
  }
}

/// Left-looking, two columns at a time. Rows hold y_ik = L_ik d_k; `work` holds rows j, j + 1 of L.
void condense(int inner, int m, int rows, double* matrix, double* inverse, double* negative, double* ratio,
              double* work) {
  Vec count = broadcast(0), least = broadcast(1);
  double *l0 = work, *l1 = work + static_cast<long>(m) * lanes;
  const auto pivot = [&](int j, const Vec& d, const Vec& before) {
    group(inverse, j) = 1.0 / d;
    const Vec magnitude = d < 0 ? -d : d, scale = before < 0 ? -before : before;
    const Vec relative = magnitude / scale;
    count += d < 0 ? broadcast(1) : broadcast(0);
    least = relative < least ? relative : least;
  };
  int j = 0;
  while (j < m) {
    const int depth = j < inner ? j : inner;
    const bool eliminate = j < inner;
    // A pair does not straddle the border between what is eliminated and what stays.
    const bool pair = j + 1 < m && (j + 1 < inner || j >= inner);
    double* row0 = matrix + static_cast<long>(j) * m * lanes;
    double* row1 = pair ? row0 + static_cast<long>(m) * lanes : row0;
    Vec s00 = broadcast(0), s10 = broadcast(0), s11 = broadcast(0);
    for (int k = 0; k < depth; ++k) {
      const Vec y0 = group(row0, k), y1 = group(row1, k);
      const Vec a = y0 * group(inverse, k), c = y1 * group(inverse, k);
      group(l0, k) = a;
      group(l1, k) = c;
      s00 += y0 * a;
      s10 += y1 * a;
      s11 += y1 * c;
    }
    const Vec before0 = group(row0, j), d0 = before0 - s00;
    group(row0, j) = d0;
    if (eliminate) pivot(j, d0, before0);
    Vec l10 = broadcast(0);
    if (pair) {
      const Vec y10 = group(row1, j) - s10;
      group(row1, j) = y10;
      const Vec before1 = group(row1, j + 1);
      Vec d1 = before1 - s11;
      if (eliminate) {
        l10 = y10 * group(inverse, j);
        d1 -= y10 * l10;
      }
      group(row1, j + 1) = d1;
      if (eliminate) pivot(j + 1, d1, before1);
    }
    int i = j + 1 + pair;
    if (pair) {
      for (; i + 3 < rows; i += 4) column_pair<4>(matrix, m, i, j, depth, eliminate, l10, l0, l1);
      for (; i < rows; ++i) column_pair<1>(matrix, m, i, j, depth, eliminate, l10, l0, l1);
    } else {
      for (; i < rows; ++i) {
        double* row = matrix + static_cast<long>(i) * m * lanes;
        Vec sum = broadcast(0);
        for (int k = 0; k < depth; ++k) sum += group(row, k) * group(l0, k);
        group(row, j) -= sum;
      }
    }
    j += 1 + pair;
  }
  at(negative) = count;
  at(ratio) = least;
}

void reduce(int inner, int m, const double* matrix, const double* inverse, double* gradient) {
  for (int j = 0; j < m; ++j) {
    const double* row = matrix + static_cast<long>(j) * m * lanes;
    const int depth = j < inner ? j : inner;
    Vec s0 = broadcast(0), s1 = broadcast(0);
    int k = 0;
    for (; k + 1 < depth; k += 2) {
      s0 += group(gradient, k) * group(inverse, k) * group(row, k);
      s1 += group(gradient, k + 1) * group(inverse, k + 1) * group(row, k + 1);
    }
    if (k < depth) s0 += group(gradient, k) * group(inverse, k) * group(row, k);
    group(gradient, j) -= s0 + s1;
  }
}

void expand_step(int inner, int m, const double* matrix, const double* inverse, const double* gradient,
                 const double* border, const double* step_h, double* x) {
  const long stride = static_cast<long>(m) * lanes;
  for (int j = inner - 1; j >= 0; --j) {
    Vec s0 = group(gradient, j), s1 = broadcast(0), s2 = broadcast(0), s3 = broadcast(0);
    if (border) s1 = group(border, j) * at(step_h);
    const double* y = matrix + static_cast<long>(j) * lanes;
    // The latest x last, so that the chain of dependent sums is short.
    int i = m - 1;
    for (; i - 3 > j; i -= 4) {
      s0 += at(y + i * stride) * group(x, i);
      s1 += at(y + (i - 1) * stride) * group(x, i - 1);
      s2 += at(y + (i - 2) * stride) * group(x, i - 2);
      s3 += at(y + (i - 3) * stride) * group(x, i - 3);
    }
    for (; i > j; --i) s0 += at(y + i * stride) * group(x, i);
    group(x, j) = -group(inverse, j) * ((s0 + s1) + (s2 + s3));
  }
}

}  // namespace

extern const Elimination elimination;
const Elimination elimination = {condense, reduce, expand_step};

}  // namespace extremal::EXTREMAL_LEVEL
