#pragma once

#include <Eigen/Dense>
#include <complex>
#include <optional>
#include <vector>

#include "system/lagrangian.hpp"

/// \file The energy of a motion that rests near an equilibrium, by the length of the rest.

namespace extremal {

/// A sum of exponential functions of the length of a rest.
class RestEnergy {
 public:
  struct Term {
    std::complex<double> weight, rate;  ///< weight · e^−rate·length
  };
  struct Value {
    double log;        ///< of its size
    double stiffness;  ///< −∂log/∂length
    bool positive;
  };
  RestEnergy() = default;
  /// Terms that are smaller than errors of the tails are left out.
  explicit RestEnergy(std::vector<Term> terms);
  Value at(double length) const;
  /// The length next to this one at which the energy has that sign and falls in size as the rest becomes
  /// longer; so long a rest is held in time. Motions that turn about the equilibrium have many such lengths.
  std::optional<double> held_near(double length, bool positive) const;
  bool held_at(double length, bool positive) const;

 private:
  std::vector<Term> terms_;
};

/// Motion near an equilibrium, z = (q − equilibrium, q') with z' = Az: M q'' = K q + (Cᵀ − C) q' with the
/// second derivatives of L. What approaches the equilibrium and what leaves it, z = z_s + z_u, are
/// exponential functions, also where C turns the path; the energy z·Wz/2 is z_u·W z_s, for each of them alone
/// has none.
class NearEquilibrium {
 public:
  /// Near q, where L is stationary without velocity.
  NearEquilibrium(const Lagrangian& lagrangian, std::span<const double> q);

  /// Whether all motions approach or leave.
  bool hyperbolic() const { return stable_.cols() > 0 && stable_.cols() == unstable_.cols(); }
  /// L at the equilibrium.
  double cost() const { return values_.value; }

  /// Where a motion passes a tail or ends: what leaves there is small in the tail before a rest, and what
  /// approaches in that after it. At an end q is given.
  struct Passage {
    std::span<const double> q, v;
    bool end = false;
  };
  /// Of a rest from one passage to another.
  RestEnergy energy(const Passage& before, const Passage& after, double roundoff) const;

 private:
  Eigen::VectorXcd deviation(const Passage& passage) const;
  std::vector<RestEnergy::Term> from_end(const Eigen::VectorXcd& leaving, const Eigen::VectorXcd& rates,
                                         const Eigen::MatrixXcd& away, const Eigen::MatrixXcd& back,
                                         const Eigen::VectorXcd& displaced) const;

  std::vector<double> q_;
  PointValues values_;
  Eigen::MatrixXd form_;                ///< W
  Eigen::MatrixXcd stable_, unstable_;  ///< columns
  Eigen::VectorXcd decays_, growths_;   ///< rates, with positive real parts
};

}  // namespace extremal
