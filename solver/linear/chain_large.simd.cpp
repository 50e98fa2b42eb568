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

/// Rows of `to` are columns of b, n × n.
void load_transposed(const double* b, int n, double* to, int stride) {
  const int whole = n & -lanes;
  for (int i = 0; i < whole; i += lanes)
    for (int j = 0; j < whole; j += lanes) {
      Vec rows[lanes];
      for (int k = 0; k < lanes; ++k) rows[k] = load(b + (i + k) * n + j);
      transpose(rows);
      for (int k = 0; k < lanes; ++k) at(to + (j + k) * stride + i) = rows[k];
    }
  for (int i = 0; i < n; ++i)
    for (int j = i < whole ? whole : 0; j < n; ++j) to[j * stride + i] = b[i * n + j];
}

/// W := [D; B]ᵀ with zeros in the padding; returns Σ |entries| of D and B.
double load_block(const Layout& l, const double* d, const double* b, double* w) {
  const int n = l.size;
  for (int i = 0; i < l.half * l.stride; i += lanes) at(w + i) = Vec{};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) w[j * l.stride + i] = d[j * n + i];
  if (b) load_transposed(b, n, w + l.half, l.stride);
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
    take_rows(w + first * l.stride, l.stride, v + first, w, first, l.stride, first & -lanes, l.stride);
    for (int j = first; j < last; ++j) {
      pivot(l, j, magnitude(diagonal[j * (l.size + 1)]), w, v, taken, m);
      for (int i = j + 1; i < last; ++i) {
        const double factor = v[j * l.stride + i];
        for (int c = first & -lanes; c < l.stride; c += lanes)
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
  double scale = load_block(l, diagonal, blocks > 1 ? lower : nullptr, w);
  for (int k = 0; k < blocks; ++k) {
    double* const v = l.rows(memory, k);
    eliminate(l, diagonal + k * nn, w, v, taken, m);
    const double total = sum(taken, size);
    m.scale += scale;
    m.growth = larger(m.growth, total - mild_growth * scale);
    m.wild = larger(m.wild, total - wild_growth * scale);
    if (k + 1 == blocks) break;
    scale = sum(lower + k * nn, nn) +
            load_block(l, diagonal + (k + 1) * nn, k + 2 < blocks ? lower + (k + 1) * nn : nullptr, next);
    for (int j = 0; j < size; j += tile)
      take_rows(next + j * l.stride, l.stride, v + l.half + j, w + l.half, size, l.stride, j & -lanes,
                l.half);
    for (int c = 0; c < l.half; ++c) taken[c] = taken[l.half + c], taken[l.half + c] = 0;
    double* const swap = w;
    w = next, next = swap;
  }
  *monitor = m;
}

/// x −= Σ_{i < lanes} y_i v_i, rows v_i of `count` columns.
inline void subtract_rows(double* x, const double* v, Vec y, int stride, int count) {
  int c = 0;
  for (; c + lanes <= count; c += lanes) {
    Vec even = load(x + c), odd = {};
    for (int i = 0; i < lanes; i += 2) {
      even -= y[i] * at(v + i * stride + c);
      odd += y[i + 1] * at(v + (i + 1) * stride + c);
    }
    store(x + c, even - odd);
  }
  for (; c < count; ++c)
    for (int i = 0; i < lanes; ++i) x[c] -= y[i] * v[i * stride + c];
}

/// sum_i += Σ_c v_i(c) x(c) lane by lane; what is left over of the columns goes to lane 0.
inline void add_products(Vec* sum, const double* v, const double* x, int stride, int count) {
  int c = 0;
  for (; c + lanes <= count; c += lanes) {
    const Vec y = load(x + c);
    for (int i = 0; i < lanes; ++i) sum[i] += at(v + i * stride + c) * y;
  }
  for (; c < count; ++c)
    for (int i = 0; i < lanes; ++i) sum[i][0] += v[i * stride + c] * x[c];
}

/// Rows j and after, fewer than `lanes`, of L y = x.
void forward_few(const Layout& l, const double* v, int j, double* x, bool more) {
  for (; j < l.size; ++j) {
    const double* const row = v + j * l.stride;
    subtract(x + j + 1, row + j + 1, x[j], l.size - j - 1);
    if (more) subtract(x + l.size, row + l.half, x[j], l.size);
  }
}

void backward_few(const Layout& l, const double* v, int first, double* x, bool more) {
  for (int j = l.size - 1; j >= first; --j) {
    const double* const row = v + j * l.stride;
    double s = x[j] * l.inverse(v)[j] - dot(row + j + 1, x + j + 1, l.size - j - 1);
    if (more) s -= dot(row + l.half, x + l.size, l.size);
    x[j] = s;
  }
}

void solve_one(const Layout& l, const double* memory, int blocks, double* x) {
  const int n = l.size, whole = n & -lanes;
  for (int k = 0; k < blocks; ++k, x += n) {
    const double* const v = l.rows(memory, k);
    for (int first = 0; first < whole; first += lanes) {
      const double* const rows = v + first * l.stride;
      Vec y = load(x + first);
      for (int j = 0; j < lanes; ++j)
        y -= y[j] * at(rows + j * l.stride + first);  // V is zero up to its pivot
      store(x + first, y);
      subtract_rows(x + first + lanes, rows + first + lanes, y, l.stride, n - first - lanes);
      if (k + 1 < blocks) subtract_rows(x + n, rows + l.half, y, l.stride, n);
    }
    forward_few(l, v, whole, x, k + 1 < blocks);
  }
  for (int k = blocks - 1; k >= 0; --k) {
    x -= n;
    const double* const v = l.rows(memory, k);
    backward_few(l, v, whole, x, k + 1 < blocks);
    for (int first = whole - lanes; first >= 0; first -= lanes) {
      const double* const rows = v + first * l.stride;
      Vec sum[lanes] = {};
      add_products(sum, rows + first + lanes, x + first + lanes, l.stride, n - first - lanes);
      if (k + 1 < blocks) add_products(sum, rows + l.half, x + n, l.stride, n);
      Vec y = load(x + first) * at(l.inverse(v) + first) - sum_lanes(sum);
      for (int i = lanes - 2; i >= 0; --i)
        for (int j = lanes - 1; j > i; --j) y[i] -= rows[i * l.stride + first + j] * y[j];
      store(x + first, y);
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

/// Right-hand sides from column c on, as many at a time as a register holds, then half as many, and so on.
template <int wide>
void solve_from(int c, const Layout& l, const double* memory, int blocks, double* x, int columns) {
  for (; c + wide <= columns; c += wide)
    solve_columns<typename Doubles<wide>::type>(l, memory, blocks, x + c, columns);
  if constexpr (wide > 1) solve_from<wide / 2>(c, l, memory, blocks, x, columns);
}

void solve(const double* memory, int blocks, int size, double* x, int columns) {
  const Layout l(size);
  columns == 1 ? solve_one(l, memory, blocks, x) : solve_from<lanes>(0, l, memory, blocks, x, columns);
}

}  // namespace

ChainKernels large_chain(int size) {
  const Layout l(size);
  return {factor, solve, l.stage(), 2 * std::size_t(l.half) * l.stride + l.stride};
}

}  // namespace extremal::EXTREMAL_LEVEL
