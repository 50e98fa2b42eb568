#include "linear/front_kernels.hpp"
#include "linear/row_kernels.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// A 1×1 pivot may be so much smaller than the largest entry of its row among the pivots.
constexpr double threshold = 0.1;

inline void swap(double& a, double& b) {
  const double c = a;
  a = b;
  b = c;
}

/// `vectors` × lanes columns of a row: −= Σ_{t < count} v[t] w[t].
template <int vectors>
inline void complete(double* to, const double* v, const double* w, int count, int stride) {
  Vec sum[vectors];
  for (int c = 0; c < vectors; ++c) sum[c] = at(to + lanes * c);
  for (int t = 0; t < count; ++t, v += stride, w += stride)
    for (int c = 0; c < vectors; ++c) sum[c] -= *v * at(w + lanes * c);
  for (int c = 0; c < vectors; ++c) at(to + lanes * c) = sum[c];
}

/// Elimination in progress.
struct Front {
  FrontShape s;
  double *w, *v;
  int* order;
  double *diagonal, *size, *taken, *left;  // left: what is left of the diagonal
  FrontMonitor* monitor;

  double* row(double* m, int j) const { return m + long(j) * s.stride; }

  /// Row j, by what the first `count` pivots take from it.
  void complete_row(int j, int count) const {
    int c = j & -lanes;
    double* const to = row(w, j);
    for (; c + 4 * lanes <= s.stride; c += 4 * lanes) complete<4>(to + c, v + j, w + c, count, s.stride);
    for (; c < s.stride; c += lanes) complete<1>(to + c, v + j, w + c, count, s.stride);
  }

  void exchange(int i, int k) const {
    if (i == k) return;
    for (int c = 0; c < s.stride; c += lanes) {
      const Vec x = at(row(w, i) + c);
      at(row(w, i) + c) = at(row(w, k) + c);
      at(row(w, k) + c) = x;
    }
    for (int t = 0; t < s.pivots; ++t) swap(row(w, t)[i], row(w, t)[k]);
    for (int t = 0; t < i; ++t) swap(row(v, t)[i], row(v, t)[k]);
    swap(size[i], size[k]);
    swap(taken[i], taken[k]);
    swap(left[i], left[k]);
    const int o = order[i];
    order[i] = order[k];
    order[k] = o;
  }

  /// Where |x| is largest from `from` on.
  int largest(const double* x, int from) const {
    int best = from;
    for (int k = from + 1; k < s.pivots; ++k)
      if (magnitude(x[k]) > magnitude(x[best])) best = k;
    return best;
  }

  void judge(int j, double pivot) const {
    monitor->most = larger(monitor->most, taken[j]);
    monitor->cancellation = larger(monitor->cancellation, (size[j] + taken[j]) / pivot);
  }

  /// Row j of V from that of W is made; its share is taken from the diagonals.
  void account(int j) const {
    const double *const wj = row(w, j), *const vj = row(v, j);
    for (int k = j + 1; k < s.pivots; ++k) left[k] -= wj[k] * vj[k];
    for (int c = j + 1; c < s.stride; ++c) taken[c] += magnitude(wj[c] * vj[c]);
  }

  bool take_one(int j) const {
    const double d = row(w, j)[j], r = 1 / d;
    if (!(magnitude(d) > 0 && magnitude(r) > 0)) return false;
    judge(j, magnitude(d));
    ++(d > 0 ? monitor->positive : monitor->negative);
    diagonal[2 * j] = r;
    diagonal[2 * j + 1] = 0;
    const double* const wj = row(w, j);
    double* const vj = row(v, j);
    for (int c = j & -lanes; c < s.stride; ++c) vj[c] = wj[c] * r;
    account(j);
    return true;
  }

  /// |a|, |c| < |b|/10, so that it has an eigenvalue of either sign.
  bool take_two(int j) const {
    const double *const w0 = row(w, j), *const w1 = row(w, j + 1);
    const double a = w0[j], b = w0[j + 1], c = w1[j + 1], determinant = a * c - b * b;
    if (!(magnitude(determinant) > 0 && magnitude(1 / determinant) > 0)) return false;
    judge(j, magnitude(b));
    judge(j + 1, magnitude(b));
    ++monitor->positive;
    ++monitor->negative;
    const double d0 = c / determinant, d1 = a / determinant, e = -b / determinant;
    diagonal[2 * j] = d0;
    diagonal[2 * j + 2] = d1;
    diagonal[2 * j + 1] = diagonal[2 * j + 3] = e;
    double *const v0 = row(v, j), *const v1 = row(v, j + 1);
    for (int k = j & -lanes; k < s.stride; ++k) {
      v0[k] = d0 * w0[k] + e * w1[k];
      v1[k] = e * w0[k] + d1 * w1[k];
    }
    v0[j + 1] = 0;
    account(j);
    account(j + 1);
    return true;
  }
};

bool eliminate(const FrontShape& shape, double* w, double* v, int* order, double* diagonal, double* size,
               double* taken, double* work, FrontMonitor* monitor) {
  const Front f{shape, w, v, order, diagonal, size, taken, work, monitor};
  for (int k = 0; k < shape.pivots; ++k) {
    order[k] = k;
    f.left[k] = f.row(w, k)[k];
  }
  for (int j = 0; j < shape.pivots;) {
    f.exchange(j, f.largest(f.left, j));
    f.complete_row(j, j);
    const double* const wj = f.row(w, j);
    const int partner = j + 1 < shape.pivots ? f.largest(wj, j + 1) : j;
    if (magnitude(wj[j]) >= threshold * magnitude(wj[partner])) {
      if (!f.take_one(j)) return false;
      ++j;
    } else {
      f.exchange(j + 1, partner);
      f.complete_row(j + 1, j);
      if (!f.take_two(j)) return false;
      j += 2;
    }
  }
  return true;
}

void update(const FrontShape& s, const double* v, const double* w, double* u, int first, int end) {
  const int columns = s.stride - s.half;
  for (int i = first; i < end; i += tile)
    take_rows(u + long(i) * columns, columns, v + s.half + i, w + s.half, s.pivots, s.stride, i & -lanes,
              columns);
}

void extend(const FrontShape& child, const double* u, const int* to, const int* run, const FrontShape& s,
            double* w, double* parent_u) {
  const int columns = child.stride - child.half, parent_columns = s.stride - s.half;
  for (int i = 0; i < child.rest; ++i, u += columns) {
    double* const row = to[i] < s.half ? w + long(to[i]) * s.stride
                                       : parent_u + long(to[i] - s.half) * parent_columns - s.half;
    for (int k = i; k < child.rest; k = run[k]) {
      double* const target = row + to[k] - k;
      for (int c = k; c < run[k]; ++c) target[c] += u[c];
    }
  }
}

void forward(const FrontShape& s, const double* v, const double* diagonal, double* y, double* rest) {
  for (int j = 0; j < s.pivots; ++j, v += s.stride) {
    subtract(y + j + 1, v + j + 1, y[j], s.pivots - j - 1);
    subtract(rest, v + s.half, y[j], s.rest);
  }
  for (int j = 0; j < s.pivots; ++j) {
    const double e = diagonal[2 * j + 1];
    if (e == 0) {
      y[j] *= diagonal[2 * j];
      continue;
    }
    const double y0 = y[j], y1 = y[j + 1];
    y[j] = diagonal[2 * j] * y0 + e * y1;
    y[j + 1] = e * y0 + diagonal[2 * j + 2] * y1;
    ++j;
  }
}

void backward(const FrontShape& s, const double* v, double* y, const double* rest) {
  v += long(s.pivots) * s.stride;
  for (int j = s.pivots - 1; j >= 0; --j) {
    v -= s.stride;
    y[j] -= dot(v + j + 1, y + j + 1, s.pivots - j - 1) + dot(v + s.half, rest, s.rest);
  }
}

}  // namespace

FrontKernels front_kernels() { return {padding, eliminate, update, extend, forward, backward}; }

}  // namespace extremal::EXTREMAL_LEVEL
