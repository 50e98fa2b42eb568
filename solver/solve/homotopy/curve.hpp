#pragma once

#include <vector>

#include "solve/newton/model.hpp"
#include "solve/newton/newton_loop.hpp"

/// \file Curves of extremals: equations with one unknown more than there are equations.

namespace extremal {

/// A change of a path and of the parameter of a curve.
struct Move {
  Step step;
  double parameter = 0;
  std::vector<double> times = {};  ///< by which the mesh nodes move, in τ; empty: they stay
  void add(const Move& other, double factor);
  void scale(double factor);
};

/// Extremals of which one number varies. All solutions of the equations linearised at the path are
/// correction + α·direction.
class ExtremalCurve {
 public:
  virtual ~ExtremalCurve() = default;

  /// False where the equations cannot be solved. With the factors of a path before, the direction stays.
  virtual bool linearise(Factors factors) = 0;
  Move correction, direction;

  /// Moves path and parameter; false if there is no problem there.
  virtual bool apply(const Move& move, double factor) = 0;
  virtual double dot(const Move& a, const Move& b) const = 0;
  /// Scalar product of a tangent with the nonlinear part of the last apply().
  virtual double drift(const Move&) const { return 0; }

  /// The number that varies, and its change by the direction (`along`) or by the correction.
  virtual double varied() const = 0;
  virtual double change(bool along) const { return (along ? direction : correction).parameter; }
};

/// The equation that closes those of a curve: the shortest correction (Gauss-Newton), regular also where the
/// problem with the number fixed is singular; the correction across a tangent (pseudo-arclength; Keller,
/// Numerical solution of bifurcation and nonlinear eigenvalue problems, 1977); or the one to a value of the
/// number that varies.
struct CurveBorder {
  const Move* tangent = nullptr;
  const double* value = nullptr;
};

/// The steps of a curve's equations with their border, for newton_loop(): the step is curve.correction.
struct BorderedSteps {
  ExtremalCurve& curve;
  CurveBorder border;
  bool solve(Factors factors);
};

/// Where the duration T is the number that varies: with H and t the second derivatives of S_h in x and in x
/// and T, H δx + t δT = −g leaves one direction free. Solutions with two right-hand sides of the equation
/// that closes it differ by this direction, even where H is singular. Sets a move to one solution; its
/// parameter is δT.
void solve_with_duration(QuadraticModel& model, const DiscreteAction& action, const ClosingEquation& closing,
                         Move& move);

/// The direction of a curve by `scale` is its tangent of length one, onward from the tangent `before`, with
/// which it makes an angle of this cosine. Without one before, `sense` is its sign.
struct TangentScale {
  double scale, cosine;
};
TangentScale tangent_scale(const ExtremalCurve& curve, const Move* before, double sense);

}  // namespace extremal
