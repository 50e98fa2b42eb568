#pragma once

#include <Eigen/Dense>
#include <vector>

/// \file A product of symplectic matrices taken apart by growth, without being formed.

namespace extremal {

/// The product of symplectic factors, last one leftmost, is similar to a block triangular matrix; these are
/// its diagonal blocks of growth, those of decay (their inverses transposed) left out.
struct Dichotomy {
  std::vector<Eigen::MatrixXd> growing;
  Eigen::MatrixXd centre;  ///< symplectic, of even order, perhaps empty
};

/// Orthogonal iteration through the factors, with orthogonal symplectic bases: n complex vectors x + iy stand
/// for the columns of (x; y), and of the image of a basis the complex QR factor is real (the image is
/// isotropic) and upper triangular. Where the growth from one column to the next drops, the leading columns
/// become periodic; the product then acts on them, and on what they and their conjugates leave, by itself.
Dichotomy separate(const std::vector<Eigen::MatrixXd>& factors);

}  // namespace extremal
