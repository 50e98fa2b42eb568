#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "analysis/variation.hpp"
#include "machine/roundoff.hpp"

/// \file Symplectic matrices: those of pieces, and the eigenvalues of one, in pairs.

namespace extremal {

/// Scales of the coordinates, square roots of momenta over coordinates: in them the pieces and what they
/// compose to over [0, T] have entries of moderate size.
Eigen::VectorXd symplectic_units(const SecondVariation& variation);

/// From (q, p) at the start of the piece to its end, 2n × 2n, with q·unit and p/unit as variables. Not finite
/// where B is singular.
Eigen::MatrixXd transfer(const Piece& piece, const Eigen::VectorXd& unit);

/// Errors of λ + 1/λ by roundoff, relative to the size of the matrix: measured at the double eigenvalues 1 of
/// a hundred orbits they were at most a quarter of this.
constexpr double sum_accuracy = 512 * machine_epsilon;

/// Eigenvalues λ and 1/λ of a symplectic matrix.
struct ReciprocalPair {
  std::complex<double>
      sum;  ///< μ = λ + 1/λ; real where |imaginary part| is within the accuracy of a double μ
  int sign =
      0;  ///< for real μ in (−2, 2): of i vᴴJv, v the eigenvector of the λ with positive imaginary part
};

/// All n of them, and the size of the matrix.
struct ReciprocalPairs {
  std::vector<ReciprocalPair> pairs;
  double scale = 0;
};
ReciprocalPairs reciprocal_pairs(const Eigen::MatrixXd& symplectic);

}  // namespace extremal
