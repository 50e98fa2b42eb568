#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/newton/newton_loop.hpp"

/// \file Pseudo-arclength continuation (Keller, Numerical solution of bifurcation and nonlinear eigenvalue
/// problems, 1977): along a curve of solutions of equations with one unknown more than there are equations.
///
/// A curve has a present point, and moves: vectors, or other values with add() and scale().
///
///   Move correction, direction         solutions of the linearised equations: correction + α·direction
///   bool linearise(Factors)            false if there are none; with old factors the direction stays
///   bool apply(const Move&, double)    moves the point by a multiple of a move; false if there is none
///   double dot(const Move&, const Move&)
///   double drift(const Move& tangent)  if any: product with the nonlinear part of the last apply()
///   double varied(), change(bool)      for to_value(): the number that varies; its change by the
///                                      direction (true) or by the correction

namespace extremal {

inline void add(Eigen::VectorXd& to, const Eigen::VectorXd& move, double factor) { to += factor * move; }
inline void scale(Eigen::VectorXd& move, double factor) { move *= factor; }

/// For newton_loop(): steps, which are curve.correction, across a tangent. Across curve.direction they are
/// the shortest (Gauss-Newton), regular also where the problem with the parameter fixed is singular.
template <class Curve, class Move>
auto across(Curve& curve, const Move& tangent) {
  return [&](Factors factors) {
    if (!curve.linearise(factors)) return false;
    double off = curve.dot(tangent, curve.correction);
    if constexpr (requires { curve.drift(tangent); }) off += curve.drift(tangent);
    const double along = curve.dot(tangent, curve.direction);
    add(curve.correction, curve.direction, -off / along);
    return along != 0;
  };
}

/// Steps to where the number that varies has a value.
template <class Curve>
auto to_value(Curve& curve, double value) {
  return [&curve, value](Factors factors) {
    if (!curve.linearise(factors)) return false;
    const double off = curve.varied() + curve.change(false) - value, along = curve.change(true);
    add(curve.correction, curve.direction, -off / along);
    return along != 0;
  };
}

/// The first correction is shorter than `longest`, others than a part of the one before or than `close`. The
/// last is shorter than `enough`, or shorter than `nearly` and no such part: roundoff.
struct Contraction {
  int most_steps;
  double part, longest, enough, close = 0, nearly = 0;
};

/// Newton's method to a point of the curve, whose steps are those of across() or to_value().
template <class Curve, class Solve>
bool contract(Curve& curve, Solve&& solve, const Contraction& wanted) {
  double longest = wanted.longest, before = INFINITY;
  const auto take = [&](bool solved) {
    if (!solved) return Progress::failed;
    const double size = std::sqrt(curve.dot(curve.correction, curve.correction));
    if (!(size < longest) || !curve.apply(curve.correction, 1)) return Progress::failed;
    const bool roundoff = size < wanted.nearly && size > wanted.part * before;
    if (size < wanted.enough || roundoff) return Progress::arrived;
    before = size;
    longest = std::max(wanted.part * size, wanted.close);
    return Progress::more;
  };
  return newton_loop(solve, wanted.most_steps, take) == Progress::arrived;
}

/// The direction of a curve by `scale` is its tangent of length one, onward from the tangent `before`, with
/// which it makes an angle of this cosine. Without one before, `sense` is its sign.
struct TangentScale {
  double scale, cosine;
};
template <class Curve, class Move>
TangentScale tangent_scale(const Curve& curve, const Move* before, double sense) {
  const double length = std::sqrt(curve.dot(curve.direction, curve.direction));
  const double along = before ? curve.dot(*before, curve.direction) : sense;
  return {std::copysign(1 / length, along),
          before ? std::abs(along) / (length * std::sqrt(curve.dot(*before, *before))) : 1};
}

/// Steps are longer than the least. A step is refused, too, where the curve turns by more than the angle with
/// the cosine `sharpest_turn`. The next try is the part `shortening` of one that was refused.
struct ArclengthLimits {
  double least_length, shortening, sharpest_turn;
};

/// Steps along a curve, in a loop of their user:
///
///   while (steps.advance(curve)) {
///     what lies between the last point and this one; or back to the last one with a smaller steps.length
///     steps.accept(steps.length);
///     a greater steps.length, or the end
///   }
///
/// Beside its equations the curve has
///
///   bool goes_on()                             whether there may be another try
///   void save(), refuse()                      keeps the present point; goes back to it
///   bool correct(const Move& tangent, double)  see contract(): back to the curve after a step of this length
template <class Move>
struct ArclengthSteps {
  ArclengthLimits limits;
  double length = 0;   ///< of the next step
  Move tangent = {};   ///< of length one
  Move previous = {};  ///< the tangent at the point before
  double way = 0;      ///< from there; 0: there is none
  Move next = {};      ///< the tangent after a step that is not yet accepted
  double cosine = 1;   ///< of the angle by which the last step turned

  /// At a point where the curve was linearised: onward from a tangent, or in a sense of the direction.
  template <class Curve>
  void begin(const Curve& curve, const Move* onward, double sense = 0) {
    way = 0;
    find_next(curve, onward, sense);
    std::swap(tangent, next);
  }

  /// Takes the first step that succeeds, which waits for accept(); false if none does.
  template <class Curve>
  bool advance(Curve& curve) {
    while (length > limits.least_length && curve.goes_on()) {
      curve.save();
      if (curve.apply(predicted(), length) && curve.correct(tangent, length)) {
        find_next(curve, &tangent, 0);
        if (cosine > limits.sharpest_turn) return true;
      }
      length *= limits.shortening;
      curve.refuse();
    }
    return false;
  }

  /// The step has led so far.
  void accept(double so_far) {
    previous = std::exchange(tangent, next);
    way = so_far;
  }

 private:
  /// By its length: the parabola through the tangents here and before.
  Move predicted() const {
    Move move = tangent;
    if (way == 0) return move;
    const double half = 0.5 * length / way;
    add(move, tangent, half);
    add(move, previous, -half);
    return move;
  }
  template <class Curve>
  void find_next(const Curve& curve, const Move* before, double sense) {
    const TangentScale onward = tangent_scale(curve, before, sense);
    next = curve.direction;
    scale(next, onward.scale);
    cosine = onward.cosine;
  }
};

}  // namespace extremal
