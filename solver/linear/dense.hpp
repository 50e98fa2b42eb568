#pragma once

#include <Eigen/LU>
#include <Eigen/QR>
#include <span>

/// \file Dense factorisations, each instantiated once: Eigen's templates would cost every file that uses one
/// several seconds to compile, and half a minute under sanitizers.

extern template class Eigen::PartialPivLU<Eigen::MatrixXd>;
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

namespace extremal {

inline std::span<double> span_of(Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
inline std::span<const double> span_of(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// Orthonormal columns that span those of `m`, r × c with c <= r.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& m);

/// Orthonormal columns across those of `m`, r × (r − c).
Eigen::MatrixXd complement(const Eigen::MatrixXd& m);

/// m = q (R over zeros): q is r × r and unitary, `pivots` the diagonal of R.
struct UnitaryBasis {
  Eigen::MatrixXcd q;
  Eigen::VectorXcd pivots;
};
UnitaryBasis unitary(const Eigen::MatrixXcd& m);

/// A⁻¹ B by LU with partial pivoting; not finite where A is singular.
Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The shortest X that minimises |AX − B|; pivots below `negligible` of the largest count as zero.
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double negligible = 0);

/// Not finite where m is singular.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& m);

/// Of a symmetric matrix, by its lower triangle; false where it is not finite.
bool positive_definite(const Eigen::MatrixXd& m);

/// In ascending order; of a symmetric (Hermitian) matrix the lower triangle is read.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& m);
Eigen::VectorXd hermitian_eigenvalues(const Eigen::MatrixXcd& m);
/// λ of A x = λ B x, B positive definite.
Eigen::VectorXd hermitian_eigenvalues(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

struct SymmetricEigen {
  Eigen::VectorXd values;  ///< ascending
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& m);

/// Of a general matrix; two columns beside each other are real and imaginary part of the vectors of a complex
/// pair of values.
struct GeneralEigen {
  Eigen::VectorXcd values;
  Eigen::MatrixXd vectors;
};
GeneralEigen general_eigen(const Eigen::MatrixXd& m);
Eigen::VectorXcd general_eigenvalues(const Eigen::MatrixXd& m);

struct ComplexEigen {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
/// Of a matrix that is normal within `accuracy` vectors are orthonormal, also where values coincide.
ComplexEigen complex_eigen(const Eigen::MatrixXd& m, double accuracy);

/// m = u diag(values) vᵀ: all of v, of u as many columns as m has, at most; values descending.
struct SingularValues {
  Eigen::MatrixXd u;
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
SingularValues singular_value_decomposition(const Eigen::MatrixXd& m);
Eigen::VectorXd singular_values(const Eigen::MatrixXd& m);
/// Singular values larger than `relative` times the largest.
int numerical_rank(const Eigen::MatrixXd& m, double relative);

/// The right singular vector of the smallest singular value.
Eigen::VectorXcd null_vector(const Eigen::MatrixXcd& m);

}  // namespace extremal
