#include "linear/chain.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "linear/chain_scale.hpp"
#include "machine/roundoff.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Blocks times the cube of their size, for all null directions of one matrix: with more it counts as
/// singular.
constexpr double most_work = 1e8;
/// The same, for one factorisation with chosen pivots that is not needed for a step.
constexpr double most_pivoted_work = 1e9;

ChainKernels kernels(int size) {
  const ChainKernels own = at_simd_level(EXTREMAL_AT_EACH_LEVEL(small_chain))(size);
  return own.factor ? own : at_simd_level(EXTREMAL_AT_EACH_LEVEL(large_chain))(size);
}

/// Roundoff in a pivot relative to the terms it is the sum of, for `order` unknowns.
double roundoff(int order) { return 64 * machine_epsilon * std::sqrt(double(order)); }

double dot(const double* a, const double* b, int count) {
  double part[4] = {}, rest = 0;
  int i = 0;
  for (; i + 4 <= count; i += 4)
    for (int k = 0; k < 4; ++k) part[k] += a[i + k] * b[i + k];
  for (; i < count; ++i) rest += a[i] * b[i];
  return (part[0] + part[1]) + (part[2] + part[3]) + rest;
}

/// to += M from, with M row-major n × n, `columns` columns.
void add_product(const double* m, const double* from, double* to, int n, int columns) {
  for (int i = 0; i < n; ++i, m += n, to += columns) {
    if (columns == 1) {
      *to += dot(m, from, n);
      continue;
    }
    for (int j = 0; j < n; ++j)
      for (int c = 0; c < columns; ++c) to[c] += m[j] * from[j * columns + c];
  }
}

/// to += Mᵀ from.
void add_transposed(const double* m, const double* from, double* to, int n, int columns) {
  for (int j = 0; j < n; ++j, m += n, from += columns) {
    if (columns == 1)
      for (int i = 0; i < n; ++i) to[i] += m[i] * *from;
    else
      for (int i = 0; i < n; ++i)
        for (int c = 0; c < columns; ++c) to[i * columns + c] += m[i] * from[c];
  }
}

}  // namespace

void Chain::resize(int blocks, int size) {
  if (blocks < 0 || size < 1)
    throw std::invalid_argument(
        fmt::format("chain: {} blocks of size {}; need at least 0 of at least 1", blocks, size));
  if (size != size_) kernels_ = kernels(size);
  blocks_ = blocks;
  size_ = size;
  factored_ = false;
  const std::size_t entries = std::size_t(blocks) * size * size;
  diagonal_.resize(entries);
  lower_.resize(entries);
  factor_.resize(blocks * kernels_.stage + kernels_.work);
}

double& Chain::diagonal_entry(int row) {
  return diagonal(row / size_)[std::size_t(row % size_) * (size_ + 1)];
}

/// Factors the blocks as they are. Returns how suspicious it is that an eigenvalue is small: the largest
/// cancellation in a pivot, or 1 / the smallest pivot that was chosen; −1 if an entry is not finite.
double Chain::factor_once(double smallest) {
  ChainMonitor m;
  kernels_.factor(diagonal(0), lower(0), blocks_, size_, factor_.data(), &m);
  inertia_ = {m.positive, m.negative, 0};
  // Not-a-number is neither positive nor negative; an infinity shows in the scale.
  const bool finite = m.positive + m.negative == order() && std::isfinite(m.scale);
  refine_ = m.growth > 0;
  pivoted_ = !(finite && m.wild <= 0 && m.cancellation * smallest < 1);
  if (!pivoted_) return m.cancellation;
  refine_ = true;
  if (!pivoted_factor_.factor(diagonal(0), lower(0), blocks_, size_, smallest)) return -1;
  inertia_ = pivoted_factor_.inertia();
  return 1 / pivoted_factor_.smallest_pivot();
}

/// Where the eigenvector to an eigenvalue at most `smallest` of the scaled matrix is largest, or −1 if
/// inverse iteration finds none. A pivot alone does not tell: the last one is λ/v² with v the last entry of
/// the vector.
int Chain::null_row(double smallest) {
  equilibrate(diagonal(0), lower(0), blocks_, size_, scale_);
  const int steps = 3;
  std::vector<double>& x = work_;
  x.resize(order());
  for (int i = 0; i < order(); ++i) x[i] = 1 + 0.5 * std::sin(1 + 7.0 * i);  // any that favours no symmetry
  double inverse = 0;
  int largest = 0;
  for (int step = 0; step < steps; ++step) {
    const double before = std::abs(x[largest]);
    for (int i = 0; i < order(); ++i) x[i] /= scale_[i] * before;
    solve_factored(x.data(), 1);
    for (int i = 0; i < order(); ++i) x[i] /= scale_[i];
    for (int i = 0; i < order(); ++i)
      if (!(std::abs(x[i]) <= std::abs(x[largest]))) largest = i;
    inverse = std::max(inverse, std::abs(x[largest]));
  }
  return inverse * smallest >= 1 ? largest : -1;
}

bool Chain::factor(double smallest) {
  inertia_ = {};
  deflated_.clear();
  factored_ = true;
  pivoted_ = refine_ = false;
  if (blocks_ == 0) return true;
  smallest = std::max(smallest, roundoff(order()));
  const double calm = std::min(1e6, 1 / std::sqrt(smallest));
  std::vector<std::pair<int, double>> saved;
  double suspicion;
  // As a second variation between fixed ends A has no more than n null directions; with many more it is
  // noise.
  const int most = std::min(order(), std::max(2 * size_, 16));
  const double work = double(blocks_) * size_ * size_ * size_;
  bool affordable = true;
  while ((suspicion = factor_once(smallest)) > calm && int(saved.size()) < most) {
    const int row = null_row(smallest);
    if (row < 0) break;
    affordable = (saved.size() + 1) * work <= most_work;
    if (!affordable) break;
    const double amount = 1 / (scale_[row] * scale_[row]);
    saved.emplace_back(row, diagonal_entry(row));
    deflated_.push_back({row, amount});
    diagonal_entry(row) += amount;
  }
  for (auto entry = saved.rbegin(); entry != saved.rend(); ++entry)
    diagonal_entry(entry->first) = entry->second;
  factored_ = affordable && suspicion >= 0;
  if (!factored_) {
    deflated_.clear();
    return false;
  }
  inertia_.positive -= int(deflated_.size());
  inertia_.zero += int(deflated_.size());
  if (pivoted_) {
    const auto more = pivoted_factor_.deflated();
    deflated_.insert(deflated_.end(), more.begin(), more.end());
  }
  return deflated_.empty();
}

/// Where elements grow pivots are chosen.
std::optional<Inertia> Chain::signs() {
  deflated_.clear();
  factored_ = false;
  if (blocks_ == 0) return Inertia{};
  ChainMonitor m;
  kernels_.factor(diagonal(0), lower(0), blocks_, size_, factor_.data(), &m);
  const bool finite = m.positive + m.negative == order() && std::isfinite(m.scale);
  if (finite && m.wild <= 0) return Inertia{m.positive, m.negative, 0};
  if (double(blocks_) * size_ * size_ * size_ > most_pivoted_work) return std::nullopt;
  if (!pivoted_factor_.factor(diagonal(0), lower(0), blocks_, size_, 0)) return std::nullopt;
  return pivoted_factor_.inertia();
}

void Chain::solve_factored(double* x, int columns) const {
  if (pivoted_)
    pivoted_factor_.solve(x, columns);
  else
    kernels_.solve(factor_.data(), blocks_, size_, x, columns);
}

void Chain::solve(double* x, int columns) const {
  if (!factored_) throw std::logic_error("chain: solve without a factorisation of finite blocks");
  if (blocks_ == 0 || columns < 1) return;
  if (!refine_) return solve_factored(x, columns);
  const std::size_t entries = std::size_t(order()) * columns;
  work_.resize(2 * entries);
  double* const b = work_.data();
  double* const r = b + entries;
  std::copy_n(x, entries, b);
  solve_factored(x, columns);
  multiply(x, r, columns);
  for (const Deflation& d : deflated())
    for (int c = 0; c < columns; ++c)
      r[std::size_t(d.row) * columns + c] += d.amount * x[std::size_t(d.row) * columns + c];
  for (std::size_t i = 0; i < entries; ++i) r[i] = b[i] - r[i];
  solve_factored(r, columns);
  for (std::size_t i = 0; i < entries; ++i) x[i] += r[i];
}

void Chain::solve_step(double* x) const {
  if (pivoted_ || !factored_) return solve(x, 1);
  if (blocks_ > 0) solve_factored(x, 1);
}

void Chain::multiply(const double* x, double* y, int columns) const {
  const std::size_t step = std::size_t(size_) * columns;
  std::fill_n(y, blocks_ * step, 0.0);
  for (int k = 0; k < blocks_; ++k) {
    add_product(diagonal(k), x + k * step, y + k * step, size_, columns);
    if (k + 1 == blocks_) break;
    add_product(lower(k), x + k * step, y + (k + 1) * step, size_, columns);
    add_transposed(lower(k), x + (k + 1) * step, y + k * step, size_, columns);
  }
}

}  // namespace extremal
