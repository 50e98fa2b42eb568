#include "analysis/orbit_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/symplectic.hpp"
#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Eigenvalues of a form to be eliminated, relative: below this the ends of a piece are conjugate.
constexpr double regular = 1e-11;

}  // namespace

/// Pieces are joined from the left: the node z between two of them has the form D₁ + A₂, and what it leaves
/// is
///   A = A₁ − B₁ᵀ(D₁ + A₂)⁻¹B₁,  B = −B₂(D₁ + A₂)⁻¹B₁,  D = D₂ − B₂(D₁ + A₂)⁻¹B₂ᵀ.
/// B becomes as small as fields grow, by products, so that it keeps its digits.
std::optional<OrbitForm> OrbitForm::make(const SecondVariation& variation, const MatrixXd& map) {
  OrbitForm form;
  form.unit_ = symplectic_units(variation);
  const VectorXd inverse = form.unit_.cwiseInverse();
  const auto scaled = [&](const auto& matrix) -> MatrixXd {
    return inverse.asDiagonal() * matrix * inverse.asDiagonal();
  };
  for (int k = 0; k < variation.count(); ++k) {
    const Piece piece = variation.piece(k);
    const MatrixXd a = scaled(piece.a), b = scaled(piece.b), d = scaled(piece.d);
    if (k == 0) {
      form.a_ = a, form.b_ = b, form.d_ = d;
      continue;
    }
    const SymmetricEigen node = symmetric_eigen(form.d_ + a);
    const VectorXd& values = node.values;
    if (!(values.cwiseAbs().minCoeff() > regular * values.cwiseAbs().maxCoeff())) return std::nullopt;
    form.inner_ += static_cast<int>((values.array() < 0).count());
    const MatrixXd left = node.vectors.transpose() * form.b_, right = b * node.vectors;
    const auto weights = values.cwiseInverse().asDiagonal();
    form.a_ -= left.transpose() * weights * left;
    form.d_ = d - right * weights * right.transpose();
    form.b_ = (-right * weights * left).eval();
  }
  if (map.size() == 0) return form;
  const MatrixXd r = form.unit_.asDiagonal() * map * inverse.asDiagonal();
  form.b_ = (r.transpose() * form.b_).eval();
  form.d_ = (r.transpose() * form.d_ * r).eval();
  return form;
}

/// H(ω), and for λ off the circle what is zero for its fields: A + RᵀDR + λBᵀR + λ⁻¹RᵀB.
MatrixXcd OrbitForm::form(std::complex<double> lambda) const {
  return (a_ + d_).cast<std::complex<double>>() + lambda * b_.transpose() + 1.0 / lambda * b_;
}

int OrbitForm::index(double alpha, double threshold) const {
  const MatrixXcd matrix = form(std::polar(1.0, alpha));
  const VectorXd values = hermitian_eigenvalues(matrix);
  const double null = threshold * (a_.cwiseAbs().maxCoeff() + d_.cwiseAbs().maxCoeff());
  return inner_ + static_cast<int>((values.array() < -null).count());
}

std::vector<int> OrbitForm::iterates(int most, double threshold) const {
  std::vector<int> result;
  for (int times = 1; times <= most; ++times) {
    int sum = 0;
    for (int k = 0; k < times; ++k) sum += index(2 * std::numbers::pi * k / times, threshold);
    result.push_back(sum);
  }
  return result;
}

VectorXcd OrbitForm::eigenvector(std::complex<double> lambda) const {
  const VectorXcd x = null_vector(form(lambda));
  const VectorXcd p = -(a_ * x + lambda * (b_.transpose() * x));
  VectorXcd state(2 * x.size());
  state << unit_.cwiseInverse().asDiagonal() * x, unit_.asDiagonal() * p;
  Eigen::Index largest;
  state.cwiseAbs().maxCoeff(&largest);
  return state / (state.norm() * state[largest] / std::abs(state[largest]));
}

}  // namespace extremal
