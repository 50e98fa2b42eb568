#pragma once

#include <Eigen/Dense>

/// \file Units in which the entries of a matrix are comparable.

namespace extremal {

/// Of the rows and columns of a symmetric matrix of sizes: divided by those of row and column, its rows have
/// a largest entry of about 1. A diagonal may vanish; rows do not.
inline Eigen::VectorXd equilibration(Eigen::MatrixXd size) {
  constexpr int sweeps = 3;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(size.rows());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const Eigen::VectorXd row = size.rowwise().maxCoeff().cwiseSqrt();
    unit = unit.cwiseProduct(row);
    size = row.cwiseInverse().asDiagonal() * size * row.cwiseInverse().asDiagonal();
  }
  return unit;
}

}  // namespace extremal
