#include "linear/extended_chain.hpp"

#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

TwoDoubles negative(TwoDoubles x) { return {-x.high, -x.low}; }

}  // namespace

const ExtendedKernels& extended_arithmetic() {
  static const ExtendedKernels kernels = at_simd_level(EXTREMAL_AT_EACH_LEVEL(extended_kernels))();
  return kernels;
}

void ExtendedChain::reset(int blocks, int size) {
  blocks_ = blocks;
  size_ = size;
  diagonal_.reset(order(), size);
  lower_.reset(order(), size);
}

/// Moves what is left of block k to the front of the panel, and puts block k + 1 behind it.
void ExtendedChain::load(int k) {
  const std::size_t n = size_;
  if (k == 0) {
    panel_.reset(2 * n, 3 * n);
    for (std::size_t i = 0; i < n; ++i) {
      panel_.add_scaled(n, {1, 0}, diagonal_.high(i), diagonal_.low(i), i);
      for (std::size_t j = 0; j < n && blocks_ > 1; ++j) panel_.set(i, n + j, lower_.at(j, i));
    }
  } else {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < 3 * n; ++j)
        panel_.set(i, j, j < 2 * n ? panel_.at(n + i, n + j) : TwoDoubles{});
  }
  if (k + 1 == blocks_) return;
  const std::size_t row = static_cast<std::size_t>(k) * n, next = row + n;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      panel_.set(n + i, j, lower_.at(row + i, j));
      panel_.set(n + i, n + j, diagonal_.at(next + i, j));
      panel_.set(n + i, 2 * n + j, k + 2 < blocks_ ? lower_.at(next + j, i) : TwoDoubles{});
    }
}

int ExtendedChain::pivot_row(int p, int rows) const {
  int best = p;
  for (int i = p + 1; i < rows; ++i)
    if (std::abs(panel_.high(i)[p]) > std::abs(panel_.high(best)[p])) best = i;
  return best;
}

bool ExtendedChain::factor() {
  const int n = size_;
  const std::size_t width = 3 * static_cast<std::size_t>(n);
  upper_.reset(order(), width);
  multipliers_.reset(order(), 2 * static_cast<std::size_t>(n));
  exchanged_.resize(order());
  for (int k = 0; k < blocks_; ++k) {
    load(k);
    const int rows = k + 1 < blocks_ ? 2 * n : n;
    for (int p = 0; p < n; ++p) {
      const std::size_t at = static_cast<std::size_t>(k) * n + p;
      const int best = pivot_row(p, rows);
      exchanged_[at] = best;
      if (best != p) panel_.swap(p, best);
      const TwoDoubles pivot = panel_.at(p, p);
      if (pivot.high == 0 || !std::isfinite(pivot.high)) return false;
      for (int i = p + 1; i < rows; ++i) {
        const TwoDoubles factor = extended_arithmetic().divide(panel_.at(i, p), pivot);
        multipliers_.set(at, i, factor);
        panel_.add_scaled(width - p - 1, negative(factor), panel_.high(p) + p + 1, panel_.low(p) + p + 1, i,
                          p + 1);
      }
      upper_.add_scaled(width, {1, 0}, panel_.high(p), panel_.low(p), at);
    }
  }
  return true;
}

void ExtendedChain::solve(ExtendedRows& x) const {
  const std::size_t n = size_, columns = x.columns();
  for (int k = 0; k < blocks_; ++k) {
    const std::size_t first = static_cast<std::size_t>(k) * n, rows = k + 1 < blocks_ ? 2 * n : n;
    for (std::size_t p = 0; p < n; ++p) {
      const std::size_t at = first + p, other = first + exchanged_[at];
      if (other != at) x.swap(at, other);
      for (std::size_t i = p + 1; i < rows; ++i)
        x.add_scaled(columns, negative(multipliers_.at(at, i)), x.high(at), x.low(at), first + i);
    }
  }
  for (int k = blocks_ - 1; k >= 0; --k) {
    const std::size_t first = static_cast<std::size_t>(k) * n,
                      width = std::min<std::size_t>(3 * n, order() - first);
    for (std::size_t p = n; p-- > 0;) {
      const std::size_t at = first + p;
      for (std::size_t c = p + 1; c < width; ++c)
        x.add_scaled(columns, negative(upper_.at(at, c)), x.high(first + c), x.low(first + c), at);
      const TwoDoubles pivot = upper_.at(at, p);
      for (std::size_t c = 0; c < columns; ++c)
        x.set(at, c, extended_arithmetic().divide(x.at(at, c), pivot));
    }
  }
}

Inertia ExtendedChain::inertia() const {
  const std::size_t n = size_;
  ExtendedRows front;  // what is left of a block, and the rows that couple it with the next
  front.reset(2 * n, 2 * n);
  Inertia signs;
  for (int k = 0; k < blocks_; ++k) {
    const std::size_t row = static_cast<std::size_t>(k) * n;
    const bool last = k + 1 == blocks_;
    for (std::size_t i = 0; i < n; ++i) {
      front.add_scaled(n, {1, 0}, diagonal_.high(row + i), diagonal_.low(row + i), i);
      for (std::size_t j = 0; j < n && !last; ++j) {
        front.set(n + i, j, lower_.at(row + i, j));
        front.set(j, n + i, lower_.at(row + i, j));
      }
    }
    for (std::size_t p = 0; p < n; ++p) {
      const TwoDoubles pivot = front.at(p, p);
      ++(pivot.high > 0 ? signs.positive : pivot.high < 0 ? signs.negative : signs.zero);
      if (pivot.high == 0) continue;
      for (std::size_t i = p + 1; i < 2 * n; ++i)
        front.add_scaled(2 * n - p - 1, negative(extended_arithmetic().divide(front.at(i, p), pivot)),
                         front.high(p) + p + 1, front.low(p) + p + 1, i, p + 1);
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < 2 * n; ++j) front.set(i, j, j < n ? front.at(n + i, n + j) : TwoDoubles{});
    for (std::size_t i = n; i < 2 * n; ++i)
      for (std::size_t j = 0; j < 2 * n; ++j) front.set(i, j, {});
  }
  return signs;
}

}  // namespace extremal
