#include "linear/chain_kernels.hpp"
#include "machine/lanes.hpp"

// Small blocks: everything about one block stays in registers, and the chain is burnt at both ends. A
// pivot waits for a division, so one direction alone leaves the processor idle; block k from the top and
// block N−1−k from the bottom are independent until they meet, and Sylvester's law does not mind the
// order. The two directions are the two lanes of a Pair. (The compiler's own vectorisation is off for
// this file: it packs across rows and pays more for the shuffles than it gains.)

namespace extremal::EXTREMAL_LEVEL {

namespace {

typedef double Pair __attribute__((vector_size(16), may_alias));
typedef long long PairMask __attribute__((vector_size(16), may_alias));

inline Pair magnitude(Pair x) {
  return reinterpret_cast<Pair>(reinterpret_cast<PairMask>(x) & PairMask{~(1LL << 63), ~(1LL << 63)});
}
inline Pair larger(Pair a, Pair b) { return a > b ? a : b; }

/// The factor of one block from the top (lane 0) and of one from the bottom (lane 1): A = L D Lᵀ, with L
/// the strict lower triangle of the block and, below it, the rows of the next block in that direction.
template <int n>
struct Stage {
  Pair inverse[n];  // of the pivots
  Pair inside[n][n];
  Pair next[n][n];
};

/// What is left of a block after the elimination of those before it.
template <int n>
struct Front {
  Pair s[n][n];   // lower triangle
  Pair taken[n];  // Σ w²/|d| taken from each diagonal entry
  Pair size[n];   // |a_ii|
  Pair scale;     // Σ |entries| of the block and its coupling
};

struct PairMonitor {
  Pair scale = {}, growth = {}, wild = {}, cancellation = {};
  PairMask positive = {}, negative = {};
};

template <int n>
inline void load(Front<n>& f, const double* top, const double* bottom) {
  f.scale = Pair{};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      f.s[i][j] = Pair{top[i * n + j], bottom[i * n + j]};
      f.scale += magnitude(f.s[i][j]);
    }
    f.size[i] = magnitude(f.s[i][i]);
    f.taken[i] = Pair{};
  }
}

/// L D Lᵀ of the front itself.
template <int n>
inline void eliminate(Front<n>& f, Stage<n>& out, PairMonitor& m) {
  Pair taken = {};
  for (int j = 0; j < n; ++j) {
    const Pair d = f.s[j][j], r = 1 / d;
    out.inverse[j] = r;
    m.positive -= d > 0;
    m.negative -= d < 0;
    taken += f.taken[j];
    m.cancellation = larger(m.cancellation, (f.size[j] + f.taken[j]) * magnitude(r));
    for (int i = j + 1; i < n; ++i) {
      const Pair l = f.s[i][j] * r;
      for (int k = j + 1; k <= i; ++k) f.s[i][k] -= l * f.s[k][j];
      f.taken[i] += magnitude(l * f.s[i][j]);
      out.inside[i][j] = l;
    }
  }
  m.scale += f.scale;
  m.growth = larger(m.growth, taken - mild_growth * f.scale);
  m.wild = larger(m.wild, taken - wild_growth * f.scale);
}

/// Takes the eliminated blocks out of their neighbours `f`. From the top the coupling has the neighbour's
/// rows, from the bottom its columns.
template <int n>
inline void couple(Front<n>& f, const double* top, const double* bottom, Stage<n>& out) {
  for (int i = 0; i < n; ++i) {
    Pair w[n];
    for (int j = 0; j < n; ++j) {
      w[j] = Pair{top[i * n + j], bottom[j * n + i]};
      f.scale += magnitude(w[j]);
      for (int p = 0; p < j; ++p) w[j] -= w[p] * out.inside[j][p];
      out.next[i][j] = w[j] * out.inverse[j];
      f.taken[i] += magnitude(w[j] * out.next[i][j]);
    }
    for (int k = 0; k <= i; ++k)
      for (int j = 0; j < n; ++j) f.s[i][k] -= w[j] * out.next[k][j];
  }
}

/// Lane 1 in both lanes, with lane 0 added if the directions met in one block.
template <int n>
inline Front<n> meet(const Front<n>& f, bool same) {
  const auto join = [&](Pair x) { return same ? Pair{x[0] + x[1], x[0] + x[1]} : Pair{x[1], x[1]}; };
  Front<n> out;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) out.s[i][j] = join(f.s[i][j]);
    out.taken[i] = join(f.taken[i]);
    out.size[i] = join(f.size[i]);
  }
  out.scale = join(f.scale);
  return out;
}

inline double larger(double a, double b) { return a > b ? a : b; }

/// Both lanes of `ends`, and of `meeting` lane 0, where the blocks that are left were eliminated.
inline ChainMonitor merge(const PairMonitor& ends, const PairMonitor& meeting) {
  const auto most = [](Pair a, Pair b) { return larger(larger(a[0], a[1]), b[0]); };
  return {ends.scale[0] + ends.scale[1] + meeting.scale[0],
          most(ends.growth, meeting.growth),
          most(ends.wild, meeting.wild),
          most(ends.cancellation, meeting.cancellation),
          int(ends.positive[0] + ends.positive[1] + meeting.positive[0]),
          int(ends.negative[0] + ends.negative[1] + meeting.negative[0])};
}

template <int n>
void factor(const double* diagonal, const double* lower, int blocks, int, double* memory,
            ChainMonitor* monitor) {
  static constexpr double zero[n * n] = {};
  constexpr int nn = n * n;
  Stage<n>* stage = reinterpret_cast<Stage<n>*>(memory);
  PairMonitor ends, meeting;
  Front<n> f;
  load(f, blocks > 1 ? diagonal : zero, diagonal + (blocks - 1) * nn);
  int k = 0, l = blocks - 1;
  for (; k + 1 < l; ++k, --l) {
    eliminate(f, *stage, ends);
    load(f, diagonal + (k + 1) * nn, k + 1 < l - 1 ? diagonal + (l - 1) * nn : zero);
    couple(f, lower + k * nn, lower + (l - 1) * nn, *stage++);
  }
  Front<n> last = meet(f, k == l);
  if (k < l) {
    eliminate(f, *stage, meeting);
    couple(last, lower + k * nn, lower + k * nn, *stage++);
  }
  eliminate(last, *stage, meeting);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) stage->next[i][j] = Pair{};
  *monitor = merge(ends, meeting);
}

template <int n, class T>
inline void read(T* to, const double* x, int columns) {
  for (int i = 0; i < n; ++i) __builtin_memcpy(to + i, x + i * columns, sizeof(T));
}
template <int n, class T>
inline void write(const T* from, double* x, int columns) {
  for (int i = 0; i < n; ++i) __builtin_memcpy(x + i * columns, from + i, sizeof(T));
}

/// y := L⁻¹ y within the block, kept at x, and takes it out of `next`. The y that is the latest to be
/// known comes last in every sum.
template <int lane, int n, class T>
inline void forward(const Stage<n>& s, T* y, double* x, int columns, T* next) {
  for (int i = 1; i < n; ++i)
    for (int j = 0; j < i; ++j) y[i] -= s.inside[i][j][lane] * y[j];
  write<n>(y, x, columns);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) next[i] -= s.next[i][j][lane] * y[j];
}

/// x := L⁻ᵀ (D⁻¹ y − nextᵀ known) in place for one block; `known` moves on to it.
template <int lane, int n, class T>
inline void backward(const Stage<n>& s, double* x, int columns, T* known) {
  T here[n];
  read<n>(here, x, columns);
  for (int i = n - 1; i >= 0; --i) {
    here[i] *= s.inverse[i][lane];
    for (int j = n - 1; j >= 0; --j) here[i] -= s.next[j][i][lane] * known[j];
    for (int j = n - 1; j > i; --j) here[i] -= s.inside[j][i][lane] * here[j];
  }
  write<n>(here, x, columns);
  for (int i = 0; i < n; ++i) known[i] = here[i];
}

/// As many right-hand sides as T has elements.
template <int n, class T>
inline void solve_columns(const Stage<n>* stage, int blocks, double* x, int columns) {
  const long step = long(n) * columns;
  T a[n], b[n], next[n], nothing[n] = {};
  int k = 0, l = blocks - 1;
  read<n>(a, x, columns);
  read<n>(b, x + l * step, columns);
  for (; k + 1 < l; ++k, --l, ++stage) {
    read<n>(next, x + (k + 1) * step, columns);
    forward<0>(*stage, a, x + k * step, columns, next);
    for (int i = 0; i < n; ++i) a[i] = next[i];
    if (k + 1 < l - 1) read<n>(next, x + (l - 1) * step, columns);
    forward<1>(*stage, b, x + l * step, columns, next);
    for (int i = 0; i < n; ++i) b[i] = next[i];
  }
  const bool even = k < l;
  if (even) forward<0>(*stage++, a, x + k * step, columns, b);
  for (int i = 0; i < n; ++i) a[i] = T{};
  forward<0>(*stage, b, x + l * step, columns, a);
  backward<0>(*stage, x + l * step, columns, nothing);
  read<n>(a, x + l * step, columns);
  read<n>(b, x + l * step, columns);
  if (even) backward<0>(*--stage, x + k * step, columns, a);
  while (k > 0) {
    --k, ++l, --stage;
    backward<0>(*stage, x + k * step, columns, a);
    backward<1>(*stage, x + l * step, columns, b);
  }
}

/// Right-hand sides from column c on, as many at a time as a register holds, then half as many, and so on.
template <int n, int wide>
void solve_from(int c, const Stage<n>* stage, int blocks, double* x, int columns) {
  for (; c + wide <= columns; c += wide)
    solve_columns<n, typename Doubles<wide>::type>(stage, blocks, x + c, columns);
  if constexpr (wide > 1) solve_from<n, wide / 2>(c, stage, blocks, x, columns);
}

template <int n>
void solve(const double* memory, int blocks, int, double* x, int columns) {
  solve_from<n, lanes>(0, reinterpret_cast<const Stage<n>*>(memory), blocks, x, columns);
}

template <int n>
ChainKernels kernels() {
  return {factor<n>, solve<n>, sizeof(Stage<n>) / sizeof(double), 0};
}

}  // namespace

ChainKernels small_chain(int size) {
  switch (size) {
    case 1:
      return kernels<1>();
    case 2:
      return kernels<2>();
    case 3:
      return kernels<3>();
    case 4:
      return kernels<4>();
    case 5:
      return kernels<5>();
    case 6:
      return kernels<6>();
    default:
      return {nullptr, nullptr, 0, 0};
  }
}

}  // namespace extremal::EXTREMAL_LEVEL
