#include "rivals/correction.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include <cmath>

#include "linear/dense.hpp"

namespace extremal {

namespace {

/// Directions whose singular value is below this part of the largest entry count as free.
constexpr double least_singular = 1e-6;
constexpr int refinements = 3;
/// Among orbits of a family the nearest in q is meant: momenta may be off by much more.
constexpr double weight_of_momenta = 0.03;

using Entries = std::vector<Eigen::Triplet<double>>;

void add_dense(Entries& entries, Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& block) {
  for (Eigen::Index j = 0; j < block.cols(); ++j)
    for (Eigen::Index i = 0; i < block.rows(); ++i)
      if (block(i, j) != 0) entries.emplace_back(row + i, column + j, block(i, j));
}

struct LinearSystem {
  Eigen::SparseMatrix<double> matrix;
  Eigen::VectorXd right;
};

LinearSystem assemble(const std::vector<MotionPiece>& pieces, const EndConditions::Values& conditions,
                      const PhaseScales& scales) {
  const Eigen::Index size = pieces.front().transition.rows(), n = size / 2;
  const auto count = static_cast<Eigen::Index>(pieces.size());
  const bool free_duration = pieces.front().by_duration.size() > 0;
  const Eigen::Index rows = count * size + conditions.residual.size(),
                     columns = (count + 1) * size + (free_duration ? 1 : 0);
  Entries entries;
  LinearSystem system{Eigen::SparseMatrix<double>(rows, columns), Eigen::VectorXd(rows)};
  for (Eigen::Index k = 0; k < count; ++k) {
    add_dense(entries, k * size, k * size, pieces[k].transition);
    for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(k * size + i, (k + 1) * size + i, -1.0);
    if (free_duration) add_dense(entries, k * size, columns - 1, pieces[k].by_duration);
    system.right.segment(k * size, size) = -pieces[k].defect;
  }
  const auto weight = [&](Eigen::Index row) {
    return conditions.size[row] > 0 ? 1 / conditions.size[row] : 1.0;
  };
  for (const Triplet& e : conditions.derivatives) {
    const double scale = (e.column / n) % 2 == 0 ? scales.q : scales.p;
    const Eigen::Index column = e.column < size ? e.column : count * size + e.column - size;
    entries.emplace_back(count * size + e.row, column, e.value * scale * weight(e.row));
  }
  for (Eigen::Index row = 0; row < conditions.residual.size(); ++row)
    system.right[count * size + row] = -conditions.residual[row] * weight(row);
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

}  // namespace

/// Iterated Tikhonov regularisation, x += (AᵀA + μ²)⁻¹ Aᵀ (b − A x).
Eigen::VectorXd correction(const std::vector<MotionPiece>& pieces, const EndConditions::Values& conditions,
                           const PhaseScales& scales) {
  const LinearSystem system = assemble(pieces, conditions, scales);
  const Eigen::SparseMatrix<double> transposed = system.matrix.transpose();
  Eigen::SparseMatrix<double> normal = transposed * system.matrix;
  const double largest = normal.diagonal().maxCoeff();
  const Eigen::Index size = pieces.front().transition.rows();
  for (Eigen::Index i = 0; i < normal.rows(); ++i) {
    const double weight = least_singular * (i % size < size / 2 ? 1 : weight_of_momenta);
    normal.coeffRef(i, i) += weight * weight * largest;
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(normal);
  if (factors.info() != Eigen::Success) return {};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.matrix.cols());
  for (int k = 0; k <= refinements; ++k) x += factors.solve(transposed * (system.right - system.matrix * x));
  if (!x.allFinite()) return {};
  return x.head((static_cast<Eigen::Index>(pieces.size()) + 1) * pieces.front().transition.rows());
}

double largest_change(const std::vector<MotionPiece>& pieces, const Eigen::VectorXd& correction) {
  const Eigen::Index size = pieces.front().transition.rows(), n = size / 2;
  double largest = 0;
  for (Eigen::Index k = 0; k * size < correction.size(); ++k)
    largest = std::max(largest, correction.segment(k * size, n).cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < pieces.size(); ++k)
    for (const Waypoint& waypoint : pieces[k].waypoints) {
      const Eigen::VectorXd change =
          waypoint.transition * correction.segment(static_cast<Eigen::Index>(k) * size, size) +
          waypoint.defect;
      largest = std::max(largest, change.cwiseAbs().maxCoeff());
    }
  return largest;
}

/// Of the fields that leave q(0) where it is, an orthonormal basis of what they span; what it was made from
/// is it times a triangular matrix, which tells by the signs on its diagonal whether it turned them round.
double orientation(const std::vector<MotionPiece>& pieces) {
  const Eigen::Index n = pieces.front().transition.rows() / 2;
  Eigen::MatrixXd fields = Eigen::MatrixXd::Zero(2 * n, n);
  fields.bottomRows(n).setIdentity();
  int sign = 1;
  for (const MotionPiece& piece : pieces) {
    const Eigen::MatrixXd next = piece.transition * fields;
    fields = orthonormal(next);
    if (((fields.transpose() * next).diagonal().array() < 0).count() % 2 != 0) sign = -sign;
  }
  const Eigen::MatrixXd q = fields.topRows(n);
  return std::copysign(singular_values(q).minCoeff(), sign * q.determinant());
}

}  // namespace extremal
