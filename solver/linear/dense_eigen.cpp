#include <Eigen/Eigenvalues>

#include "linear/dense.hpp"

namespace extremal {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

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

/// Of a normal matrix the Schur vectors are eigenvectors.
ComplexEigen complex_eigen(const MatrixXd& m, double accuracy) {
  const Eigen::ComplexSchur<MatrixXd> schur(m);
  const MatrixXcd& t = schur.matrixT();
  if ((t - MatrixXcd(t.diagonal().asDiagonal())).norm() < accuracy) return {t.diagonal(), schur.matrixU()};
  const Eigen::EigenSolver<MatrixXd> general(m);
  return {general.eigenvalues(), general.eigenvectors()};
}

}  // namespace extremal
