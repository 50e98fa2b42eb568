#pragma once

#include <Eigen/LU>
#include <span>
#include <vector>

#include "system/extended_hessian.hpp"
#include "system/lagrangian.hpp"

/// \file The motion of a Lagrangian system with more digits: encounters amplify the roundoff of double.

namespace extremal {

/// As Flow, for L = ½ q'ᵀ M q' + q'ᵀ C q + aᵀ q' + R(q, t); Real is Extended or DoubleDouble.
template <class Real>
class ExtendedFlow {
 public:
  /// Whether L has that form, few coordinates, and derivatives in extended precision.
  static bool suits(const Lagrangian& lagrangian);
  /// `lagrangian` must outlive it.
  explicit ExtendedFlow(const Lagrangian& lagrangian);

  /// p = M q' + C q + a. False if it is not finite.
  bool momentum(std::span<const Real> q, std::span<const Real> v, Real t, std::span<Real> p) const;
  /// q' for y = (q, p).
  void velocity(std::span<const Real> y, std::span<Real> v);
  /// (q, p)' for y = (q, p); false if it is not finite.
  bool slope(Real t, std::span<const Real> y, std::span<Real> slope);
  /// Whether second derivatives are known too.
  bool has_variations() const { return hessian_ != nullptr; }
  /// As Flow::slope_with_variations, if they are.
  bool slope_with_variations(Real t, std::span<const Real> y, std::span<Real> slope);

 private:
  void add_gyroscopic_force(std::span<const Real> v, std::span<Real> force) const;
  void solve_mass(std::span<Real> v);

  const Lagrangian& lagrangian_;
  const Structure& structure_;
  const ExtendedHessian* hessian_;
  Eigen::PartialPivLU<Eigen::MatrixXd> mass_;
  std::vector<double> diagonal_;  ///< of M, if it has nothing else
  Eigen::VectorXd part_;
  std::vector<Real> rows_, rest_;
  PointScratch<Real> scratch_;
};

}  // namespace extremal
