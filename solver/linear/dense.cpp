#include "linear/dense.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

template class Eigen::PartialPivLU<Eigen::MatrixXd>;
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

namespace extremal {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

MatrixXd orthonormal(const MatrixXd& m) {
  if (m.cols() == 0) return m;
  return Eigen::HouseholderQR<MatrixXd>(m).householderQ() * MatrixXd::Identity(m.rows(), m.cols());
}

MatrixXd complement(const MatrixXd& m) {
  const auto rows = m.rows(), rest = rows - m.cols();
  return Eigen::HouseholderQR<MatrixXd>(m).householderQ() * MatrixXd::Identity(rows, rows).rightCols(rest);
}

UnitaryBasis unitary(const MatrixXcd& m) {
  const Eigen::HouseholderQR<MatrixXcd> qr(m);
  return {qr.householderQ(), qr.matrixQR().diagonal()};
}

MatrixXd solved(const MatrixXd& a, const MatrixXd& b) { return Eigen::PartialPivLU<MatrixXd>(a).solve(b); }

MatrixXd least_norm(const MatrixXd& a, const MatrixXd& b, double negligible) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factors(a.rows(), a.cols());
  if (negligible > 0) factors.setThreshold(negligible);
  return factors.compute(a).solve(b);
}

MatrixXd inverse(const MatrixXd& m) { return Eigen::PartialPivLU<MatrixXd>(m).inverse(); }

bool positive_definite(const MatrixXd& m) {
  return m.allFinite() && Eigen::LLT<MatrixXd>(m).info() == Eigen::Success;
}

SingularValues singular_value_decomposition(const MatrixXd& m) {
  const Eigen::BDCSVD<MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

VectorXd singular_values(const MatrixXd& m) { return Eigen::BDCSVD<MatrixXd>(m).singularValues(); }

int numerical_rank(const MatrixXd& m, double relative) {
  if (m.size() == 0) return 0;
  const VectorXd values = singular_values(m);
  return static_cast<int>((values.array() > relative * values[0]).count());
}

VectorXcd null_vector(const MatrixXcd& m) {
  return Eigen::JacobiSVD<MatrixXcd>(m, Eigen::ComputeFullV).matrixV().rightCols(1);
}

}  // namespace extremal
