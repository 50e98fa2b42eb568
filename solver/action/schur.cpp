#include <algorithm>

#include "action/discrete_action.hpp"
#include "machine/simd.hpp"

/// \file What condensation left of the elements, gathered to the blocks of the nodes that they couple.

namespace extremal {

/// The blocks that take up the Schur complement of element k: the nodes at its ends, and what couples them.
DiscreteAction::Blocks DiscreteAction::blocks(int k) {
  const bool first = k == 0, last = k == elements_ - 1;
  return {first ? nodes.first.data() : nodes.chain.diagonal(k - 1),
          last ? nodes.last.data() : nodes.chain.diagonal(k),
          first  ? nodes.first_lower.data()
          : last ? nodes.last_lower.data()
                 : nodes.chain.lower(k - 1)};
}

void DiscreteAction::gather_schur(int b) {
  const double* schur = matrix(b) + static_cast<std::size_t>(condensation_->fronts.ends()) * lanes_;
  const int first = b * lanes_, last = std::min(elements_, first + lanes_), n = n_;
  const auto entry = [&](int i, int j, int lane) {
    return schur[(static_cast<std::size_t>(i) * 2 * n + j) * lanes_ + lane];
  };
  const auto add_symmetric = [&](double* block, int offset, int lane) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j) {
        const double value = entry(offset + i, offset + j, lane);
        block[i * n + j] += value;
        if (i != j) block[j * n + i] += value;
      }
  };
  for (int k = first; k < last; ++k) {
    const int lane = k - first;
    const Blocks to = blocks(k);
    add_symmetric(to.start, 0, lane);
    add_symmetric(to.end, n, lane);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) to.lower[i * n + j] = entry(n + i, j, lane);
  }
}

/// The same row by row, all lanes at once: blocks too large to be passed over for each lane. Their upper
/// triangles are left to mirror_blocks(): rows are gathered in whole vectors, beyond the diagonal.
void DiscreteAction::gather_large_schur(int b) {
  const double* schur = matrix(b) + static_cast<std::size_t>(condensation_->fronts.ends()) * lanes_;
  const int first = b * lanes_, used = std::min(elements_ - first, lanes_);
  const std::size_t row = static_cast<std::size_t>(2 * n_) * lanes_;
  double *start[most_lanes], *end[most_lanes], *lower[most_lanes];
  for (int lane = 0; lane < used; ++lane) {
    const Blocks to = blocks(first + lane);
    start[lane] = to.start;
    end[lane] = to.end;
    lower[lane] = to.lower;
  }
  for (int i = 0; i < n_; ++i, schur += row) {
    const int count = std::min(n_, (i / lanes_ + 1) * lanes_);
    const double* const second = schur + n_ * row;
    elimination_->scatter(schur, count, used, true, start);
    elimination_->scatter(second + n_ * lanes_, count, used, true, end);
    elimination_->scatter(second, n_, used, false, lower);
    for (int lane = 0; lane < used; ++lane) {
      start[lane] += n_;
      end[lane] += n_;
      lower[lane] += n_;
    }
  }
}

/// Tile by tile, so that the rows that are written stay in the nearest cache.
void DiscreteAction::mirror(double* block, int n) {
  constexpr int tile = 32;
  for (int rows = 0; rows < n; rows += tile)
    for (int columns = 0; columns <= rows; columns += tile)
      for (int i = rows; i < std::min(rows + tile, n); ++i)
        for (int j = columns; j < std::min(columns + tile, i); ++j)
          block[std::size_t(j) * n + i] = block[std::size_t(i) * n + j];
}

void DiscreteAction::mirror_blocks() {
  mirror(nodes.first.data(), n_);
  mirror(nodes.last.data(), n_);
  for (int k = 0; k < nodes.chain.blocks(); ++k) mirror(nodes.chain.diagonal(k), n_);
}

void DiscreteAction::copy_condensed(int batch, std::span<double* const> start, std::span<double* const> lower,
                                    std::span<double* const> end) const {
  const double* row = matrix(batch) + static_cast<std::size_t>(condensation_->fronts.ends()) * lanes_;
  const std::size_t stride = static_cast<std::size_t>(2 * n_) * lanes_;
  const int used = static_cast<int>(start.size());
  double* to[most_lanes];
  const auto copy = [&](const double* from, int count, std::span<double* const> blocks, int i) {
    for (std::size_t k = 0; k < blocks.size(); ++k) to[k] = blocks[k] + std::size_t(i) * n_;
    if (!blocks.empty()) elimination_->scatter(from, count, used, false, to);
  };
  for (int i = 0; i < n_; ++i, row += stride) {
    const double* const second = row + n_ * stride;
    copy(row, i + 1, start, i);
    copy(second, n_, lower, i);
    copy(second + std::size_t(n_) * lanes_, i + 1, end, i);
  }
  for (double* const block : start) mirror(block, n_);
  for (double* const block : end) mirror(block, n_);
}

void DiscreteAction::gather_border(int b) {
  const double* row = reduced(b) + sizes_.vector;
  const double* corner = sums(b, of_corner);
  double taken[most_lanes];
  eliminated(b, row, row, taken);
  const int first = b * lanes_, last = std::min(elements_, first + lanes_);
  for (int k = first; k < last; ++k) {
    const int lane = k - first;
    double* node = nodes.border.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) node[a] += row[(inner_ + a) * lanes_ + lane];
    nodes.corner += corner[lane] - taken[lane];
  }
}

}  // namespace extremal
