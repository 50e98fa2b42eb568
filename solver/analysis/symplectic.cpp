#include "analysis/symplectic.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "linear/equilibration.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Sums this near to each other, relative, share their eigenvectors.
constexpr double same_sum = 1e-9;

/// A skew-Hamiltonian matrix (A G; Q Aᵀ), G and Q skew, on its way to Q = 0 and A of Hessenberg's form by
/// orthogonal symplectic similarities: C. F. Van Loan, Linear Algebra Appl. 61 (1984) 233.
class SkewHamiltonian {
 public:
  explicit SkewHamiltonian(MatrixXd matrix)
      : n_(matrix.rows() / 2),
        matrix_(std::move(matrix)),
        basis_(MatrixXd::Identity(2 * n_, 2 * n_)),
        work_(2 * n_) {
    for (Eigen::Index j = 0; j + 1 < n_; ++j) {
      reflect(j + 1, matrix_.col(j).segment(n_ + j + 1, n_ - j - 1));
      rotate(j + 1, j);
      reflect(j + 1, matrix_.col(j).segment(j + 1, n_ - j - 1));
    }
  }

  /// A, whose eigenvalues are those of the matrix, each of which is double there.
  MatrixXd half() const { return matrix_.topLeftCorner(n_, n_); }
  /// 2n × n, orthonormal: A w = μ w makes basis() w an eigenvector.
  auto basis() const { return basis_.leftCols(n_); }

 private:
  /// Makes a multiple of e_1 of x, which belongs to rows `from` … of one half, in both halves alike.
  void reflect(Eigen::Index from, const VectorXd& x) {
    if (x.size() < 2) return;
    VectorXd essential(x.size() - 1);
    double tau, beta;
    x.makeHouseholder(essential, tau, beta);
    for (Eigen::Index first : {from, n_ + from}) {
      matrix_.middleRows(first, x.size()).applyHouseholderOnTheLeft(essential, tau, work_.data());
      matrix_.middleCols(first, x.size()).applyHouseholderOnTheRight(essential, tau, work_.data());
      basis_.middleCols(first, x.size()).applyHouseholderOnTheRight(essential, tau, work_.data());
    }
  }

  /// Makes entry (n + row, column) zero by the one at (row, column).
  void rotate(Eigen::Index row, Eigen::Index column) {
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(matrix_(row, column), matrix_(n_ + row, column));
    matrix_.applyOnTheLeft(row, n_ + row, rotation.adjoint());
    matrix_.applyOnTheRight(row, n_ + row, rotation);
    basis_.applyOnTheRight(row, n_ + row, rotation);
  }

  Eigen::Index n_;
  MatrixXd matrix_, basis_;
  VectorXd work_;
};

/// C + C⁻¹ of a symplectic C, whose inverse is −JCᵀJ.
MatrixXd with_inverse(const MatrixXd& c) {
  const auto n = c.rows() / 2;
  MatrixXd sum = c;
  sum.topLeftCorner(n, n) += c.bottomRightCorner(n, n).transpose();
  sum.topRightCorner(n, n) -= c.topRightCorner(n, n).transpose();
  sum.bottomLeftCorner(n, n) -= c.bottomLeftCorner(n, n).transpose();
  sum.bottomRightCorner(n, n) += c.topLeftCorner(n, n).transpose();
  return sum;
}

bool on_circle(const ReciprocalPair& pair) { return pair.sum.imag() == 0 && std::abs(pair.sum.real()) < 2; }

/// In the plane of v and its conjugate every x has xᵀJCx = 2 sin(arg λ) i vᴴJv: one sign. Planes of the same
/// μ share an eigenspace of C + C⁻¹, of which `fields` spans a half; the inertia of the form tells the signs.
void find_signs(std::vector<ReciprocalPair>& pairs, std::size_t first, std::size_t end, const MatrixXd& c,
                const MatrixXd& fields) {
  const auto n = c.rows() / 2, count = static_cast<Eigen::Index>(end - first);
  MatrixXd x = fields.middleCols(static_cast<Eigen::Index>(first), count);
  if (count > 1) x = orthonormal(x);
  const MatrixXd image = c * x;
  MatrixXd form = x.topRows(n).transpose() * image.bottomRows(n);
  form -= x.bottomRows(n).transpose() * image.topRows(n);
  form = ((form + form.transpose()) / 2).eval();
  const VectorXd values = count == 1 ? VectorXd(form.diagonal()) : symmetric_eigenvalues(form);
  for (std::size_t k = first; k < end; ++k)
    pairs[k].sign = values[static_cast<Eigen::Index>(k - first)] < 0 ? -1 : 1;
}

}  // namespace

VectorXd symplectic_units(const SecondVariation& variation) {
  const int n = variation.coordinates(), count = variation.count();
  MatrixXd size = MatrixXd::Zero(n, n), rigid = MatrixXd::Zero(n, n);
  for (int k = 0; k < count; ++k) {
    const Piece piece = variation.piece(k);
    size += (piece.a.cwiseAbs() + piece.b.cwiseAbs() + piece.b.transpose().cwiseAbs() + piece.d.cwiseAbs()) /
            count;
    rigid += (piece.a + piece.b + piece.b.transpose() + piece.d).cwiseAbs() / count;
  }
  // Entries are m/h and h V'': their geometric mean is that of an oscillator, mω; a free motion has m/T.
  VectorXd unit = equilibration(size);
  const VectorXd inverse = unit.cwiseInverse();
  const VectorXd stiffness = (inverse.asDiagonal() * rigid * inverse.asDiagonal()).rowwise().maxCoeff();
  const double least = 1.0 / (static_cast<double>(count) * count);
  return unit.array() * stiffness.array().max(least).sqrt().sqrt();
}

MatrixXd transfer(const Piece& piece, const VectorXd& unit) {
  const auto n = piece.a.rows();
  const VectorXd inverse = unit.cwiseInverse();
  const auto scaled = [&](const auto& form) -> MatrixXd {
    return inverse.asDiagonal() * form * inverse.asDiagonal();
  };
  // p_a = −(A q_a + Bᵀq_b) gives q_b, and then p_b = B q_a + D q_b.
  MatrixXd result(2 * n, 2 * n);
  result.topLeftCorner(n, n) = scaled(piece.a);
  result.topRightCorner(n, n).setIdentity();
  result.topRows(n) = solved(scaled(-piece.b.transpose()), result.topRows(n));
  result.bottomRows(n).noalias() = scaled(piece.d) * result.topRows(n);
  result.bottomLeftCorner(n, n) += scaled(piece.b);
  return result;
}

/// The sums μ are the eigenvalues of C + C⁻¹, each of them twice; at μ = 2 it has no Jordan block where C has
/// one of order 2, so that μ is as good there as elsewhere.
ReciprocalPairs reciprocal_pairs(const MatrixXd& c) {
  const MatrixXd sum = with_inverse(c);
  const SkewHamiltonian reduced(sum);
  ReciprocalPairs result;
  result.scale = c.norm();
  const GeneralEigen found = general_eigen(reduced.half());
  const double resolved = std::sqrt(sum_accuracy * result.scale);
  const auto n = c.rows() / 2;
  std::vector<Eigen::Index> order(n);
  for (Eigen::Index k = 0; k < n; ++k) order[k] = k;
  const VectorXcd& values = found.values;
  std::stable_sort(order.begin(), order.end(),
                   [&](auto i, auto j) { return values[i].real() < values[j].real(); });
  MatrixXd vectors(n, n);  // of a double μ that came out complex, real and imaginary part
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::complex<double> value = values[order[k]];
    result.pairs.push_back({std::abs(value.imag()) <= resolved ? value.real() : value});
    vectors.col(k) = found.vectors.col(order[k]).normalized();
  }
  const MatrixXd fields = reduced.basis() * vectors;
  for (std::size_t first = 0, end; first < result.pairs.size(); first = end) {
    end = first + 1;
    if (!on_circle(result.pairs[first])) continue;
    while (end < result.pairs.size() && on_circle(result.pairs[end]) &&
           result.pairs[end].sum.real() - result.pairs[end - 1].sum.real() < same_sum)
      ++end;
    find_signs(result.pairs, first, end, c, fields);
  }
  return result;
}

}  // namespace extremal
