#pragma once

#include <Eigen/Dense>
#include <limits>
#include <optional>
#include <vector>

#include "analysis/variation.hpp"
#include "linear/symmetric_elimination.hpp"

/// \file Jacobi fields carried along a trajectory, and the times conjugate to where they vanish.

namespace extremal {

/// The n Jacobi fields that vanish at one time, at the ends of the pieces that follow: the columns of
/// (X, P), values and momenta, whose span is all that counts (a Lagrangian subspace). While X is far from
/// singular they are normalised to X = I, with P = W symmetric, and W follows from piece to piece by the
/// recursion of block elimination. A time is conjugate where X is singular.
///
/// Within a piece, with x at its start and A(t) the form A of the part until t, a field of the span vanishes
/// at t exactly if P x = −A(t) X x. A(t) falls strictly in the sense of quadratic forms, from +∞ on (∂A/∂t =
/// −ψ'ᵀ L_vv ψ' where ψ runs from I to 0 at t). So of the symmetric matrix Xᵀ(P + A(t) X), on the range of X,
/// each eigenvalue changes its sign once at most, and where it does is a conjugate time, as often as
/// eigenvalues do. Directions in which X vanishes at the start itself, counted there, do not take part.
class JacobiFields {
 public:
  /// Fields that vanish within piece k, at tau in [0, 1); they are carried to its end.
  void begin(SecondVariation& variation, int k, double tau);

  /// Carries them through piece k. Returns the conjugate times in it, start excluded, end included, as
  /// fractions of the piece, ascending, each as often as its multiplicity; `first_only`: no more than the
  /// first.
  const std::vector<double>& advance(SecondVariation& variation, int k, bool first_only = false);

  /// From now on conjugate times are searched for in a piece only while their number times the cube of the
  /// coordinates, summed up, is at most this; where it is more, they are given up.
  void allow(double work) { work_left_ = work; }
  bool given_up() const { return work_left_ < 0; }

  /// From the end of piece k, which follows the last one passed, to the nearest conjugate time before or
  /// after it, as a fraction of the piece: by extrapolation, so good where it is small; infinite where it
  /// surely is not.
  double distance(SecondVariation& variation, int k);

 private:
  bool step(const Piece& piece);
  bool advance_large(SecondVariation& variation, int k, bool first_only);
  std::optional<double> distance_large(SecondVariation& variation, int k, double step);
  void split(const Piece& piece);
  Eigen::MatrixXd orthonormal(const Eigen::VectorXd& unit) const;
  Eigen::MatrixXd form(SecondVariation& variation, int k, double tau);
  void find(SecondVariation& variation, int k, int count);
  double time_of_zero(SecondVariation& variation, int k, int index);
  void carry(const Piece& piece);

  double work_left_ = std::numeric_limits<double>::infinity();
  bool normalised_ = false;
  Eigen::MatrixXd x_, p_;  // normalised: p_ is W and x_ is not used
  int vanishing_ = 0;      // directions in which X counts as zero
  std::vector<double> times_;
  struct Sample {
    double tau;
    Eigen::VectorXd values;
  };
  std::vector<Sample> samples_;  ///< of the eigenvalues in a piece

  // On the way through a piece, in units of unit_, X = U Σ Vᵀ: U √Σ, and √Σ UᵀP V √Σ⁻¹.
  Eigen::VectorXd unit_, eigenvalues_;
  Eigen::MatrixXd range_, share_, whole_, next_, from_start_, from_end_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  std::optional<SymmetricElimination> elimination_;
};

}  // namespace extremal
