#include "linear/cyclic.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <stdexcept>

namespace extremal {

void Cyclic::resize(int blocks, int size, int border) {
  if (blocks < 1 || size < 1 || border < 0)
    throw std::invalid_argument(fmt::format(
        "cyclic: {} blocks of size {} with a border of {}; need at least 1, 1, 0", blocks, size, border));
  blocks_ = blocks;
  size_ = size;
  border_ = border;
  chain_.resize(blocks - 1, size);
  arrow_.resize(chain_.order(), size + border);
  ends_.assign(3 * std::size_t(size) * size, 0.0);
  columns_.resize(std::size_t(blocks) * size * border);
  corner_.resize(std::size_t(border) * border);
}

bool Cyclic::factor() {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int n = size_, inner = chain_.order(), m = n + border_;
  const Eigen::Map<const Matrix> last(ends_.data(), n, n), below(ends_.data() + n * n, n, n),
      closing(ends_.data() + 2 * n * n, n, n), columns(columns_.data(), inner + n, border_),
      corner(corner_.data(), border_, border_);
  Eigen::Map<Matrix> c(arrow_.column_block(), inner, m), d(arrow_.corner(), m, m);
  d.topLeftCorner(n, n) = last;
  d.topRightCorner(n, border_) = columns.bottomRows(n);
  d.bottomLeftCorner(border_, n) = columns.bottomRows(n).transpose();
  d.bottomRightCorner(border_, border_) = corner;
  c.leftCols(n).setZero();
  c.rightCols(border_) = columns.topRows(inner);
  if (blocks_ == 1) {
    d.topLeftCorner(n, n) += closing + closing.transpose();
  } else {
    c.topLeftCorner(n, n) += closing;
    c.block(inner - n, 0, n, n) += below.transpose();
  }
  return arrow_.factor(chain_);
}

}  // namespace extremal
