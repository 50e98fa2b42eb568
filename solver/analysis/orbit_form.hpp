#pragma once

#include <Eigen/Dense>
#include <complex>
#include <optional>
#include <vector>

#include "analysis/variation.hpp"

/// \file The second variation of a periodic orbit by its values at one time.

namespace extremal {

/// δ²S over [0, T] of Jacobi fields by their values at both ends, xᵀAx + 2yᵀBx + yᵀDy with x = η(0), y =
/// η(T), and how many negative squares it has where both ends rest. Of an orbit that closes by q(T) = R q(0)
/// + c the form on fields with η(T) = ω R η(0), |ω| = 1, is x*H(ω)x,
///   H(ω) = A + RᵀDR + ωBᵀR + ω̄RᵀB,
/// beside those negative squares.
class OrbitForm {
 public:
  /// `map` is R, empty for the identity. Nothing where the ends of pieces are conjugate to the start to
  /// roundoff.
  static std::optional<OrbitForm> make(const SecondVariation& variation, const Eigen::MatrixXd& map);

  /// Negative squares on fields with η(T) = e^{iα} R η(0); those within `threshold` of zero, relative, are
  /// null.
  int index(double alpha, double threshold = 1e-8) const;

  /// Morse index of the orbit run through 1, 2, … most times, which is the sum of index(α) over the roots of
  /// unity: R. Bott, Comm. Pure Appl. Math. 9 (1956) 171.
  std::vector<int> iterates(int most, double threshold = 1e-8) const;

  /// (q, p) at t = 0, 2n, of length one, largest component positive: of the field with η(T) = λ R η(0) and
  /// p(T) = λ R⁻ᵀ p(0). Where λ is double with one such field, that one.
  Eigen::VectorXcd eigenvector(std::complex<double> lambda) const;

 private:
  OrbitForm() = default;
  Eigen::MatrixXcd form(std::complex<double> lambda) const;

  Eigen::VectorXd unit_;
  Eigen::MatrixXd a_, b_, d_;  ///< in these units, with y as R⁻¹η(T)
  int inner_ = 0;              ///< negative squares where both ends rest
};

}  // namespace extremal
