#include "system/expression_inverse.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace extremal::expression_matrix {

namespace {

/// Larger matrices that are not numbers have no expression of reasonable size.
constexpr int most_symbolic = 16;
constexpr int most_by_minors = 3;

Matrix inverse_of_numbers(Algebra& algebra, const Matrix& a) {
  const auto k = static_cast<Eigen::Index>(a.size());
  Eigen::MatrixXd numbers(k, k);
  for (Eigen::Index i = 0; i < k; ++i)
    for (Eigen::Index j = 0; j < k; ++j) {
      const Scaled& entry = a[i][j];
      numbers(i, j) = entry.zero() ? 0 : entry.factor * algebra.graph()[entry.node].value;
    }
  // Units of the rows differ: the rank is that of the matrix with unit rows.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(k);
  for (int pass = 0; pass < 4; ++pass) {
    const Eigen::VectorXd size =
        (unit.asDiagonal() * numbers * unit.asDiagonal()).cwiseAbs().rowwise().maxCoeff();
    for (Eigen::Index i = 0; i < k; ++i) unit[i] /= size[i] > 0 ? std::sqrt(size[i]) : 1;
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(unit.asDiagonal() * numbers * unit.asDiagonal());
  if (!numbers.allFinite() || !lu.isInvertible()) throw Singular();
  const Eigen::MatrixXd inverse = unit.asDiagonal() * lu.inverse() * unit.asDiagonal();
  Matrix m(a.size(), Row(a.size()));
  for (Eigen::Index i = 0; i < k; ++i)
    for (Eigen::Index j = 0; j < k; ++j)
      m[i][j] =
          k == 1 ? algebra.reciprocal(a[0][0]) : algebra.constant(0.5 * inverse(i, j) + 0.5 * inverse(j, i));
  return m;
}

/// a⁻¹ = adj(a)/det(a), regular wherever a is.
Matrix inverse_by_minors(Algebra& algebra, const Matrix& a) {
  const std::size_t k = a.size();
  Matrix m(k, Row(k));
  const auto minor = [&](std::size_t i, std::size_t j) -> Scaled {  // with its sign
    if (k == 1) return algebra.constant(1);
    if (k == 2) return i == j ? a[1 - i][1 - j] : -a[i][j];
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return algebra.subtract(algebra.multiply(a[i1][j1], a[i2][j2]), algebra.multiply(a[i1][j2], a[i2][j1]));
  };
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = minor(i, j);
  Scaled determinant;
  for (std::size_t j = 0; j < k; ++j)
    determinant = algebra.add(determinant, algebra.multiply(a[0][j], m[j][0]));
  if (determinant.zero()) throw Singular();
  const Scaled scale = algebra.reciprocal(determinant);
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = m[j][i] = algebra.multiply(m[i][j], scale);
  return m;
}

/// By elimination in place, with pivots on the diagonal, numbers first. Nothing where the diagonal has none.
std::optional<Matrix> inverse_by_pivots(Algebra& algebra, const Matrix& given) {
  const std::size_t k = given.size();
  Matrix a = given, m(k, Row(k));
  for (std::size_t i = 0; i < k; ++i) m[i][i] = algebra.constant(1);
  std::vector<Scaled> pivots(k);
  std::vector<bool> done(k);
  // Gauss-Jordan; the rows are divided by their pivots in the end.
  for (std::size_t step = 0; step < k; ++step) {
    std::size_t pivot = k;
    for (std::size_t i = 0; i < k; ++i) {
      if (done[i] || a[i][i].zero()) continue;
      if (pivot == k ||
          (algebra.graph().is_constant(a[i][i].node) && !algebra.graph().is_constant(a[pivot][pivot].node)))
        pivot = i;
    }
    if (pivot == k) {
      bool nothing = true;
      for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < k; ++j) nothing = nothing && (done[i] || done[j] || a[i][j].zero());
      if (nothing) throw Singular();
      return std::nullopt;
    }
    done[pivot] = true;
    const Scaled unit = algebra.reciprocal(a[pivot][pivot]);
    for (std::size_t i = 0; i < k; ++i) {
      if (i == pivot || a[i][pivot].zero()) continue;
      const Scaled factor = algebra.multiply(a[i][pivot], unit);
      for (std::size_t j = 0; j < k; ++j) {
        a[i][j] = j == pivot ? Scaled{} : algebra.subtract(a[i][j], algebra.multiply(factor, a[pivot][j]));
        m[i][j] = algebra.subtract(m[i][j], algebra.multiply(factor, m[pivot][j]));
      }
    }
    pivots[pivot] = unit;
  }
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = m[j][i] = algebra.multiply(m[i][j], pivots[i]);
  return m;
}

}  // namespace

std::optional<Matrix> inverse(Algebra& algebra, const Matrix& a) {
  const bool numbers = std::ranges::all_of(a, [&](const Row& row) {
    return std::ranges::all_of(
        row, [&](const Scaled& entry) { return entry.zero() || algebra.graph().is_constant(entry.node); });
  });
  if (numbers) return inverse_of_numbers(algebra, a);
  if (a.size() <= most_by_minors) return inverse_by_minors(algebra, a);
  return a.size() <= most_symbolic ? inverse_by_pivots(algebra, a) : std::nullopt;
}

}  // namespace extremal::expression_matrix
