#pragma once

#include <Eigen/Dense>
#include <cmath>

/// \file Units in which the entries of a matrix are comparable.

namespace extremal {

/// Units u of the rows and columns of a symmetric matrix of sizes: its entries divided by u_i u_j have a
/// largest one of about 1 in each row. A row that vanishes has the unit 1.
inline Eigen::VectorXd equilibration(Eigen::MatrixXd size) {
  constexpr int sweeps = 3;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(size.rows());
  if (size.size() == 0) return unit;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const Eigen::VectorXd row =
        size.rowwise().maxCoeff().unaryExpr([](double x) { return x > 0 ? std::sqrt(x) : 1; });
    unit = unit.cwiseProduct(row);
    size = row.cwiseInverse().asDiagonal() * size * row.cwiseInverse().asDiagonal();
  }
  return unit;
}

}  // namespace extremal
