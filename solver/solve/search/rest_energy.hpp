#pragma once

#include <Eigen/Dense>
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "linear/dense.hpp"
#include "system/lagrangian.hpp"

/// \file The energy of a motion that rests near an equilibrium, by the length of the rest.

namespace extremal {

/// A sum of exponential functions of the length of a rest, times powers of it where rates coincide.
class RestEnergy {
 public:
  struct Term {
    std::complex<double> weight, rate;  ///< weight · length^power · e^−rate·length
    double doubt = 0;                   ///< of the weight
    int power = 0;                      ///< after a term of power p − 1 of the same rate, or 0
  };
  struct Value {
    double log;        ///< of its size
    double stiffness;  ///< −∂log/∂length
    bool positive;
  };
  /// The action of the rest, of which the energy is −∂/∂length; all by e^exponent.
  struct Action {
    double value = 0, energy = 0;
    double stiffness = 0;       ///< the second derivative of the action
    double most_stiffness = 0;  ///< its bound, where no terms cancel
    double doubt = 0;           ///< of the energy
  };
  RestEnergy() = default;
  explicit RestEnergy(std::vector<Term> terms) : terms_(std::move(terms)) {}
  Value at(double length) const;
  Action action(double length, double exponent) const;
  /// Of the largest term.
  double log_size(double length) const;
  double fastest_rate() const;
  /// Without the weights that are less than their doubts; those that roundoff hides have no doubts either.
  RestEnergy known() const;
  /// Doubts each weight as much as it differs from that of the other. False if that has other terms, as
  /// where a tail begins at an end of the path.
  bool doubt_changes(const RestEnergy& other);
  /// The length next to this one at which the energy is positive and falls as the rest becomes longer.
  /// Motions that turn about the equilibrium have many such lengths.
  std::optional<double> held_near(double length) const;
  bool held_at(double length) const;
  /// Of one of several tails, each of half the speed of the one before.
  struct OfTail {
    const RestEnergy* energy;
    double excess;  ///< of the length between the tails over that of which a result is a function
    /// The weights by that length.
    std::vector<std::complex<double>> weights() const;
  };
  /// Each weight is extrapolated to speed zero by a polynomial through the slowest of these tails, at least
  /// three. Its degree rises as long as each power changes the weight much less than the one before: a
  /// weight hidden below powers of others is no polynomial. The doubt is the last change, and what relative
  /// errors of the slowest tail as large as `roundoff` make. Nothing where tails have not the same terms.
  static std::optional<RestEnergy> extrapolated(std::span<const OfTail> tails, double roundoff);

 private:
  std::vector<Term> terms_;
};

/// Motion near an equilibrium, z' = Az for the deviations z of (q, ∂L/∂q'). What approaches the equilibrium
/// and what leaves it, z = z_s + z_u, are exponential functions, also where drifts turn the path; the energy
/// z·Wz/2 is z_u·W z_s, for each of them alone has none. By the momentum, not by q', motions along a drift
/// have no part of those that overcome it, also where the drift is not linear.
class NearEquilibrium {
 public:
  /// Near q, where L is stationary without velocity.
  NearEquilibrium(const Lagrangian& lagrangian, std::span<const double> q);

  /// Whether all motions approach or leave.
  bool hyperbolic() const {
    return stable_.rates.size() > 0 && stable_.rates.size() == unstable_.rates.size();
  }
  /// Whether the slowest motions turn about it.
  bool turns() const;
  /// L at the equilibrium.
  double cost() const { return values_.value; }

  /// Where a motion passes a tail or ends: what leaves there is small in the tail before a rest, and what
  /// approaches in that after it. At an end q is given.
  struct Passage {
    std::span<const double> q, v;
    bool end = false;
  };
  /// Of a rest from one passage to another. Speeds of ends are known to `roundoff`; `nonlinear` is the part
  /// by which the motion in the tails is none of the linear equations.
  RestEnergy energy(const Passage& before, const Passage& after, double roundoff, double nonlinear) const;

 private:
  Eigen::VectorXcd deviation(const Passage& passage) const;
  /// Motions that approach or leave, z = columns e^∓(rates + mixing)·t c. Where rates coincide and have fewer
  /// motions of their own than there are, `mixing` couples them; it is nilpotent.
  struct Motions {
    Eigen::MatrixXcd columns;
    Eigen::VectorXcd rates;  ///< with positive real parts
    Eigen::MatrixXcd mixing;
    int powers = 1;  ///< of the time, in c
    /// What is left of c after a time, by powers of it and without the exponential functions.
    std::vector<Eigen::VectorXcd> fading(const Eigen::VectorXcd& c) const;
  };
  static Motions motions(const Eigen::MatrixXd& system, const ComplexEigen& eigen,
                         const std::vector<Eigen::Index>& of, bool leaving);
  std::vector<RestEnergy::Term> from_end(const Eigen::VectorXcd& leaving, const Motions& away,
                                         const Motions& back, const Eigen::VectorXcd& displaced,
                                         double nonlinear) const;

  const Lagrangian& lagrangian_;
  std::vector<double> q_;
  PointValues values_;
  Eigen::MatrixXd form_;  ///< W
  Motions stable_, unstable_;
};

}  // namespace extremal
