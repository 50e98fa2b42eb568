#include "linear/chain_kernels.hpp"
#include "linear/row_kernels.hpp"

// Blocks of any size. Row j of W and V belongs to pivot j: W = D Lᵀ and V = Lᵀ over the columns of the
// block, padded to whole vectors, and then those of the next block, padded too. So every sum runs over
// contiguous vectors: W[j] −= Σ_p V[p][j] W[p], in tiles of four rows that stay in registers.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// The parts of the memory; `stride` doubles from row to row.
struct Layout {
  int size, half, stride;
  explicit Layout(int n) : size(n), half(padded(n)), stride(2 * padded(n)) {}
  std::size_t stage() const { return std::size_t(half) * (stride + 1); }
  double* rows(double* factor, int k) const { return factor + k * stage(); }
  const double* rows(const double* factor, int k) const { return factor + k * stage(); }
  double* inverse(double* v) const { return v + half * stride; }
  const double* inverse(const double* v) const { return v + half * stride; }
};

/// W := [D; B]ᵀ with zeros in the padding; returns Σ |entries| of D and B.
double load(const Layout& l, const double* d, const double* b, double* w) {
  const int n = l.size;
  for (int i = 0; i < l.half * l.stride; i += 8) at(w + i) = Vec{};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) w[j * l.stride + i] = d[j * n + i];
    if (b)
      for (int i = 0; i < n; ++i) w[j * l.stride + l.half + i] = b[i * n + j];
  }
  return sum(d, n * n);
}

/// Pivot j: its row is complete and everything before the diagonal is dropped.
inline void pivot(const Layout& l, int j, double size, double* w, double* v, double* taken, ChainMonitor& m) {
  double* const wj = w + j * l.stride;
  double* const vj = v + j * l.stride;
  const double d = wj[j], r = 1 / d;
  m.positive += d > 0;
  m.negative += d < 0;
  m.cancellation = larger(m.cancellation, (size + taken[j]) * magnitude(r));
  l.inverse(v)[j] = r;
  for (int i = 0; i <= j; ++i) wj[i] = 0;
  for (int c = 0; c < l.stride; ++c) {
    vj[c] = wj[c] * r;
    taken[c] += magnitude(wj[c] * vj[c]);
  }
}

/// L D Lᵀ of one block with the rows of the next below it.
void eliminate(const Layout& l, const double* diagonal, double* w, double* v, double* taken,
               ChainMonitor& m) {
  for (int first = 0; first < l.size; first += tile) {
    const int last = first + tile < l.size ? first + tile : l.size;
    take_rows(w + first * l.stride, l.stride, v + first, w, first, l.stride, first & ~7, l.stride);
    for (int j = first; j < last; ++j) {
      pivot(l, j, magnitude(diagonal[j * (l.size + 1)]), w, v, taken, m);
      for (int i = j + 1; i < last; ++i) {
        const double factor = v[j * l.stride + i];
        for (int c = first & ~7; c < l.stride; c += 8)
          at(w + i * l.stride + c) -= factor * at(w + j * l.stride + c);
      }
    }
  }
}

void factor(const double* diagonal, const double* lower, int blocks, int size, double* memory,
            ChainMonitor* monitor) {
  const Layout l(size);
  const int nn = size * size;
  ChainMonitor m = {0, 0, 0, 0, 0, 0};
  double* w = memory + blocks * l.stage();
  double* next = w + l.half * l.stride;
  double* const taken = next + l.half * l.stride;
  for (int c = 0; c < l.stride; ++c) taken[c] = 0;
  double scale = load(l, diagonal, blocks > 1 ? lower : nullptr, w);
  for (int k = 0; k < blocks; ++k) {
    double* const v = l.rows(memory, k);
    eliminate(l, diagonal + k * nn, w, v, taken, m);
    const double total = sum(taken, size);
    m.scale += scale;
    m.growth = larger(m.growth, total - mild_growth * scale);
    m.wild = larger(m.wild, total - wild_growth * scale);
    if (k + 1 == blocks) break;
    scale = sum(lower + k * nn, nn) +
            load(l, diagonal + (k + 1) * nn, k + 2 < blocks ? lower + (k + 1) * nn : nullptr, next);
    for (int j = 0; j < size; j += tile)
      take_rows(next + j * l.stride, l.stride, v + l.half + j, w + l.half, size, l.stride, j & ~7, l.half);
    for (int c = 0; c < l.half; ++c) taken[c] = taken[l.half + c], taken[l.half + c] = 0;
    double* const swap = w;
    w = next, next = swap;
  }
  *monitor = m;
}

void solve_one(const Layout& l, const double* memory, int blocks, double* x) {
  const int n = l.size;
  for (int k = 0; k < blocks; ++k, x += n)
    for (int j = 0; j < n; ++j) {
      const double* const v = l.rows(memory, k) + j * l.stride;
      subtract(x + j + 1, v + j + 1, x[j], n - j - 1);
      if (k + 1 < blocks) subtract(x + n, v + l.half, x[j], n);
    }
  for (int k = blocks - 1; k >= 0; --k) {
    x -= n;
    const double* const v = l.rows(memory, k);
    for (int j = n - 1; j >= 0; --j) {
      double s = x[j] * l.inverse(v)[j] - dot(v + j * l.stride + j + 1, x + j + 1, n - j - 1);
      if (k + 1 < blocks) s -= dot(v + j * l.stride + l.half, x + n, n);
      x[j] = s;
    }
  }
}

template <class T>
inline T read(const double* x) {
  T value;
  __builtin_memcpy(&value, x, sizeof value);
  return value;
}

/// sum[i] −= Σ_j v(i, j) x_j for four rows i; v is `across` from row to row and `along` from j to j.
template <class T>
inline void take_columns(T* sum, const double* v, int across, int along, const double* x, int count,
                         int columns) {
  for (int j = 0; j < count; ++j) {
    const T y = read<T>(x + long(j) * columns);
    for (int i = 0; i < tile; ++i) sum[i] -= v[i * across + j * along] * y;
  }
}

/// As many right-hand sides as T has elements. Tiles that reach beyond the block read padding.
template <class T>
void solve_columns(const Layout& l, const double* memory, int blocks, double* x, int columns) {
  const int n = l.size;
  const long step = long(n) * columns;
  T sum[tile];
  for (int k = 0; k < blocks; ++k, x += step) {
    const double* const v = l.rows(memory, k);
    for (int first = 0; first < n; first += tile) {
      const int count = first + tile < n ? tile : n - first;
      for (int i = 0; i < tile; ++i) sum[i] = i < count ? read<T>(x + (first + i) * columns) : T{};
      if (k > 0) take_columns(sum, l.rows(memory, k - 1) + l.half + first, 1, l.stride, x - step, n, columns);
      take_columns(sum, v + first, 1, l.stride, x, first, columns);
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < i; ++j) sum[i] -= v[(first + j) * l.stride + first + i] * sum[j];
        __builtin_memcpy(x + (first + i) * columns, sum + i, sizeof(T));
      }
    }
  }
  for (int k = blocks - 1; k >= 0; --k) {
    x -= step;
    const double* const v = l.rows(memory, k);
    for (int first = (n - 1) / tile * tile; first >= 0; first -= tile) {
      const int count = first + tile < n ? tile : n - first, after = first + count;
      const double* const rows = v + first * l.stride;
      for (int i = 0; i < tile; ++i)
        sum[i] = i < count ? read<T>(x + (first + i) * columns) * l.inverse(v)[first + i] : T{};
      if (k + 1 < blocks) take_columns(sum, rows + l.half, l.stride, 1, x + step, n, columns);
      take_columns(sum, rows + after, l.stride, 1, x + long(after) * columns, n - after, columns);
      for (int i = count - 1; i >= 0; --i) {
        for (int j = i + 1; j < count; ++j) sum[i] -= rows[i * l.stride + first + j] * sum[j];
        __builtin_memcpy(x + (first + i) * columns, sum + i, sizeof(T));
      }
    }
  }
}

typedef double Two __attribute__((vector_size(16)));
typedef double Four __attribute__((vector_size(32)));

void solve(const double* memory, int blocks, int size, double* x, int columns) {
  const Layout l(size);
  if (columns == 1) return solve_one(l, memory, blocks, x);
  int c = 0;
#ifdef __AVX512F__
  for (; c + 8 <= columns; c += 8) solve_columns<Vec>(l, memory, blocks, x + c, columns);
#endif
#ifdef __AVX__
  for (; c + 4 <= columns; c += 4) solve_columns<Four>(l, memory, blocks, x + c, columns);
#endif
  for (; c + 2 <= columns; c += 2) solve_columns<Two>(l, memory, blocks, x + c, columns);
  if (c < columns) solve_columns<double>(l, memory, blocks, x + c, columns);
}

}  // namespace

ChainKernels large_chain(int size) {
  const Layout l(size);
  return {factor, solve, l.stage(), 2 * std::size_t(l.half) * l.stride + l.stride};
}

}  // namespace extremal::EXTREMAL_LEVEL
