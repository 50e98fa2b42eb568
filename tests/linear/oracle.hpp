#pragma once

#include <Eigen/Dense>
#include <limits>
#include <random>

#include "linear/chain.hpp"

/// \file The dense oracle of the structured algebra, and random matrices.

namespace extremal::dense {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double near_roundoff = 2 * mild_growth * eps;  ///< growth below is not refined

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline Matrix matrix(const Chain& a) {
  const int n = a.size();
  Matrix m = Matrix::Zero(a.order(), a.order());
  for (int k = 0; k < a.blocks(); ++k) {
    m.block(k * n, k * n, n, n) = Eigen::Map<const Matrix>(a.diagonal(k), n, n);
    if (k + 1 == a.blocks()) break;
    const Eigen::Map<const Matrix> b(a.lower(k), n, n);
    m.block((k + 1) * n, k * n, n, n) = b;
    m.block(k * n, (k + 1) * n, n, n) = b.transpose();
  }
  return m;
}

/// Signs of the eigenvalues; those below `zero` times the largest count as zero.
inline Inertia inertia(const Matrix& a, double zero = 1e-12) {
  Inertia result;
  if (a.rows() == 0) return result;
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Matrix>(a, Eigen::EigenvaluesOnly).eigenvalues();
  const double bound = zero * values.cwiseAbs().maxCoeff();
  for (double v : values) ++(v > bound ? result.positive : v < -bound ? result.negative : result.zero);
  return result;
}

/// Largest ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) of a column, in the maximum norm.
inline double backward_error(const Matrix& a, const Matrix& x, const Matrix& b) {
  const double norm = a.cwiseAbs().rowwise().sum().maxCoeff();
  const Matrix r = b - a * x;
  double worst = 0;
  for (int c = 0; c < x.cols(); ++c) {
    const double scale = norm * x.col(c).lpNorm<Eigen::Infinity>() + b.col(c).lpNorm<Eigen::Infinity>();
    const double error = r.col(c).lpNorm<Eigen::Infinity>() / scale;
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  Matrix matrix(int rows, int columns) {
    return Matrix::NullaryExpr(rows, columns, [&](Eigen::Index, Eigen::Index) { return normal_(engine_); });
  }
  Matrix symmetric(int n) {
    const Matrix m = matrix(n, n);
    return (m + m.transpose()) / 2;
  }

  /// Random blocks with `shift` on the diagonal: indefinite at 0, definite for shift of some 4 √n.
  void fill(Chain& a, double shift) {
    const int n = a.size();
    for (int k = 0; k < a.blocks(); ++k) {
      set(a.diagonal(k), symmetric(n) + shift * Matrix::Identity(n, n));
      if (k + 1 < a.blocks()) set(a.lower(k), matrix(n, n));
    }
  }

  static void set(double* to, const Matrix& m) { Eigen::Map<Matrix>(to, m.rows(), m.cols()) = m; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace extremal::dense
