#include "linear/dense.hpp"

#include <Eigen/Dense>

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

UnitaryBasis unitary(const MatrixXcd& m) {
  const Eigen::HouseholderQR<MatrixXcd> qr(m);
  return {qr.householderQ(), qr.matrixQR().diagonal()};
}

MatrixXd solved(const MatrixXd& a, const MatrixXd& b) { return Eigen::PartialPivLU<MatrixXd>(a).solve(b); }

VectorXd least_norm(const MatrixXd& a, const VectorXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

VectorXd symmetric_eigenvalues(const MatrixXd& m) {
  if (m.size() == 0) return {};
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd hermitian_eigenvalues(const MatrixXcd& m) {
  if (m.size() == 0) return {};
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(m, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd hermitian_eigenvalues(const MatrixXcd& a, const MatrixXcd& b) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXcd>(a, b, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen symmetric_eigen(const MatrixXd& m) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(m);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

GeneralEigen general_eigen(const MatrixXd& m) {
  const Eigen::EigenSolver<MatrixXd> solver(m);
  return {solver.eigenvalues(), solver.pseudoEigenvectors()};
}

VectorXcd general_eigenvalues(const MatrixXd& m) {
  return Eigen::EigenSolver<MatrixXd>(m, false).eigenvalues();
}

SingularValues singular_value_decomposition(const MatrixXd& m) {
  const Eigen::BDCSVD<MatrixXd> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

VectorXd singular_values(const MatrixXd& m) { return Eigen::BDCSVD<MatrixXd>(m).singularValues(); }

VectorXcd null_vector(const MatrixXcd& m) {
  return Eigen::JacobiSVD<MatrixXcd>(m, Eigen::ComputeFullV).matrixV().rightCols(1);
}

}  // namespace extremal
