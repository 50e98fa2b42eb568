#include "linear/dense.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "oracle.hpp"

/// \file Dense factorisations by what defines them.

namespace extremal {
namespace {

using dense::eps;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double close = 1e3 * eps;

MatrixXd random(int rows, int columns, unsigned seed) { return dense::Random(seed).matrix(rows, columns); }

TEST(Dense, BasesAreOrthonormalAndSpan) {
  const MatrixXd m = random(7, 3, 1), q = orthonormal(m), across = complement(m);
  ASSERT_EQ(q.cols(), 3);
  ASSERT_EQ(across.cols(), 4);
  MatrixXd both(7, 7);
  both << q, across;
  EXPECT_LT((both.transpose() * both - MatrixXd::Identity(7, 7)).norm(), close);
  EXPECT_LT((across.transpose() * m).norm(), close);
  EXPECT_EQ(orthonormal(MatrixXd(4, 0)).cols(), 0);
}

TEST(Dense, UnitaryBasisAndItsPivots) {
  MatrixXcd m(5, 5);
  m.real() = random(5, 5, 2);
  m.imag() = random(5, 5, 3);
  const UnitaryBasis basis = unitary(m);
  const MatrixXcd r = basis.q.adjoint() * m;
  EXPECT_LT(MatrixXcd(r.triangularView<Eigen::StrictlyLower>()).norm(), close);
  EXPECT_LT((r.diagonal() - basis.pivots).norm(), close);
}

TEST(Dense, SolutionsAndTheShortest) {
  const MatrixXd a = random(6, 6, 4), b = random(6, 2, 5);
  EXPECT_LT((a * solved(a, b) - b).norm(), 1e4 * eps);
  // Of all x with x1 + x2 = 2 the shortest is (1, 1); the second row says the same again.
  MatrixXd twice(2, 2);
  twice << 1, 1, 2, 2;
  EXPECT_LT((least_norm(twice, VectorXd{{2, 4}}) - VectorXd::Ones(2)).norm(), close);
}

TEST(Dense, EigenvaluesAscend) {
  const MatrixXd m = random(6, 6, 6), s = m + m.transpose();
  const SymmetricEigen eigen = symmetric_eigen(s);
  EXPECT_LT((s * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), close);
  EXPECT_LT((symmetric_eigenvalues(s) - eigen.values).norm(), close);
  EXPECT_LT((hermitian_eigenvalues(s.cast<std::complex<double>>()) - eigen.values).norm(), close);
  const MatrixXcd identity = 2 * MatrixXcd::Identity(6, 6);
  EXPECT_LT((2 * hermitian_eigenvalues(s.cast<std::complex<double>>(), identity) - eigen.values).norm(),
            close);
  EXPECT_TRUE((eigen.values.tail(5).array() >= eigen.values.head(5).array()).all());
  EXPECT_EQ(symmetric_eigenvalues(MatrixXd()).size(), 0);
}

TEST(Dense, ComplexPairsHaveRealAndImaginaryPart) {
  MatrixXd m = MatrixXd::Zero(3, 3);
  m << 1, -2, 0.5, 2, 1, -1, 0, 0, 3;
  const GeneralEigen eigen = general_eigen(m);
  EXPECT_LT((general_eigenvalues(m) - eigen.values).norm(), close);
  int pairs = 0;
  for (int k = 0; k < 3; ++k) {
    if (!(eigen.values[k].imag() > 0)) continue;
    ++pairs;
    EXPECT_LT(std::abs(eigen.values[k] - std::complex<double>(1, 2)), close);
    const VectorXcd v = eigen.vectors.col(k) +
                        std::complex<double>(0, 1) * eigen.vectors.col(k + 1).cast<std::complex<double>>();
    EXPECT_LT((m * v - eigen.values[k] * v).norm(), close);
  }
  EXPECT_EQ(pairs, 1);
}

/// A cyclic permutation of six has six different eigenvalues, two of three have each value twice.
TEST(Dense, NormalMatricesHaveOrthonormalVectors) {
  for (const int length : {6, 3}) {
    MatrixXd m = MatrixXd::Zero(6, 6);
    for (int i = 0; i < 6; ++i) m(i / length * length + (i + 1) % length, i) = 1;
    const ComplexEigen eigen = complex_eigen(m, 1e-9);
    EXPECT_LT((m * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), close) << length;
    EXPECT_LT((eigen.vectors.adjoint() * eigen.vectors - MatrixXcd::Identity(6, 6)).norm(), close) << length;
  }
  MatrixXd shear(2, 2);
  shear << 1, 1, 0, 2;
  const ComplexEigen eigen = complex_eigen(shear, 1e-9);
  EXPECT_LT((shear * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), close);
}

TEST(Dense, SingularValuesDescendAndTellNullVectors) {
  MatrixXd m = random(5, 5, 7);
  m.col(4) = m.col(0) - 2 * m.col(1);
  const SingularValues svd = singular_value_decomposition(m);
  EXPECT_LT((svd.u * svd.values.asDiagonal() * svd.v.transpose() - m).norm(), close);
  EXPECT_LT((singular_values(m) - svd.values).norm(), close);
  EXPECT_LT(svd.values[4], close);
  EXPECT_GT(svd.values[3], 1e-3);
  EXPECT_LT((m * null_vector(m.cast<std::complex<double>>())).norm(), close);
}

}  // namespace
}  // namespace extremal
