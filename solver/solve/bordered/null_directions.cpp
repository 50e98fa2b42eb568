#include "solve/bordered/null_directions.hpp"

#include <cmath>
#include <vector>

#include "linear/dense.hpp"
#include "solve/bordered/limits.hpp"

namespace extremal {

using namespace limits::bordered;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd NullDirections::probe(Index size, int k) {
  VectorXd result(size);
  for (Index i = 0; i < size; ++i) result[i] = std::cos(1.0 + k + (2.3 + 0.37 * k) * static_cast<double>(i));
  return result;
}

bool NullDirections::factor(const Matrix& a, const MatrixXd& b, const MatrixXd& c) {
  const Index size = a.rows();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(a.nonZeros() + 2 * b.size());
  for (Index j = 0; j < size; ++j)
    for (Matrix::InnerIterator it(a, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < size; ++i) {
      entries.emplace_back(i, size + j, b(i, j));
      entries.emplace_back(size + j, i, c(i, j));
    }
  Matrix whole(size + b.cols(), size + b.cols());
  whole.setFromTriplets(entries.begin(), entries.end());
  count_ = static_cast<int>(b.cols());
  bordered_ = std::make_unique<Eigen::SparseLU<Matrix>>();
  bordered_->compute(whole);
  return bordered_->info() == Eigen::Success;
}

bool NullDirections::find(const Matrix& a, double threshold) {
  const Index size = a.rows();
  for (int count = 1; count <= most_null_directions; ++count) {
    MatrixXd left(size, count), right(size, count);
    for (int k = 0; k < count; ++k) {
      left.col(k) = probe(size, 2 * k + 1).normalized();
      right.col(k) = probe(size, 2 * k + 2).normalized();
    }
    if (!factor(a, left, right)) continue;
    MatrixXd unit = MatrixXd::Zero(size + count, count);
    unit.bottomRows(count).setIdentity();
    const MatrixXd v = bordered_->solve(unit), w = bordered_->transpose().solve(unit);
    if (!v.allFinite() || !w.allFinite()) continue;
    left = orthonormal(w.topRows(size));
    right = orthonormal(v.topRows(size));
    if (!(MatrixXd(a * right).colwise().norm().maxCoeff() < threshold)) return false;
    if (!factor(a, left, right)) continue;
    directions_ = right;
    const VectorXd answer = solve(probe(size, 0));
    if (answer.allFinite() && answer.lpNorm<Eigen::Infinity>() < 1 / threshold) return true;
  }
  return false;
}

VectorXd NullDirections::solve(const VectorXd& right) const {
  VectorXd whole = VectorXd::Zero(right.size() + count_);
  whole.head(right.size()) = right;
  return VectorXd(bordered_->solve(whole)).head(right.size());
}

}  // namespace extremal
