#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/newton/newton_loop.hpp"

/// \file Pseudo-arclength continuation (Keller, Numerical solution of bifurcation and nonlinear eigenvalue
/// problems, 1977): along a curve of solutions of equations with one unknown more than there are equations.
///
/// A curve has a present point. Its moves have add(move, factor) and scale(factor).
///
///   Move correction, direction         all solutions of the equations linearised at the point are
///                                      correction + α·direction
///   bool linearise(Factors)            false where they cannot be solved; with the factors of a point
///   before,
///                                      the direction stays
///   bool apply(const Move&, double)    moves the point by a factor times the move; false if there is none
///   double dot(const Move&, const Move&)
///   double drift(const Move& tangent)  where equations of the ends are nonlinear in the parameter: scalar
///                                      product of a tangent with the nonlinear part of the last apply()
///   double varied()                    for ToValue: the number that varies, and its change by the
///   double change(bool along)          direction (`along`) or by the correction

namespace extremal {

/// α from one more equation, which the correction misses by `off` and the direction changes by `along`.
template <class Curve>
bool close_correction(Curve& curve, double off, double along) {
  if (along == 0) return false;
  curve.correction.add(curve.direction, -off / along);
  return true;
}

/// Steps across a tangent, for newton_loop(): the step is curve.correction. Across curve.direction it is the
/// shortest (Gauss-Newton), regular also where the problem with the parameter fixed is singular.
template <class Curve, class Move>
struct AcrossTangent {
  Curve& curve;
  const Move& tangent;

  bool solve(Factors factors) {
    if (!curve.linearise(factors)) return false;
    double off = curve.dot(tangent, curve.correction);
    if constexpr (requires { curve.drift(tangent); }) off += curve.drift(tangent);
    return close_correction(curve, off, curve.dot(tangent, curve.direction));
  }
};
template <class Curve, class Move>
AcrossTangent(Curve&, const Move&) -> AcrossTangent<Curve, Move>;

/// Steps to where the number that varies has a value.
template <class Curve>
struct ToValue {
  Curve& curve;
  double value;

  bool solve(Factors factors) {
    return curve.linearise(factors) &&
           close_correction(curve, curve.varied() + curve.change(false) - value, curve.change(true));
  }
};
template <class Curve>
ToValue(Curve&, double) -> ToValue<Curve>;

/// How corrections shrink: the first is shorter than `longest`, each other one than a part of the one before,
/// or than `close`. The last is shorter than `enough`, or is roundoff: no such part, but shorter than
/// `nearly`.
struct Contraction {
  int most_steps;
  double part, longest, enough, close = 0, nearly = 0;
};

/// Corrections that shrink, each with new factors.
template <class Curve>
class ContractingSteps {
 public:
  ContractingSteps(Curve& curve, const Contraction& wanted)
      : most_steps(wanted.most_steps), curve_(curve), wanted_(wanted) {}

  const int most_steps;
  static Factors factors(int) { return Factors::anew; }
  Progress take(bool solved, int) {
    if (!solved) return Progress::failed;
    const double size = std::sqrt(curve_.dot(curve_.correction, curve_.correction));
    if (!(size < wanted_.longest) || !curve_.apply(curve_.correction, 1)) return Progress::failed;
    const bool roundoff = size < wanted_.nearly && size > wanted_.part * before_;
    if (size < wanted_.enough || roundoff) return Progress::arrived;
    before_ = size;
    wanted_.longest = std::max(wanted_.part * size, wanted_.close);
    return Progress::more;
  }
  static Progress exhausted() { return Progress::failed; }

 private:
  Curve& curve_;
  Contraction wanted_;
  double before_ = INFINITY;
};

/// Newton's method to the curve, across a tangent.
template <class Curve, class Move>
bool correct_across(Curve& curve, const Move& tangent, const Contraction& wanted) {
  ContractingSteps policy(curve, wanted);
  return newton_loop(AcrossTangent{curve, tangent}, policy) == Progress::arrived;
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

/// Steps along a curve. Their user has the loop, and what happens on the way:
///
///   while (steps.advance(curve)) {
///     events between the last point and this one, or back to the last point with a smaller steps.length
///     steps.accept(steps.length);
///     a greater steps.length, or the end
///   }
///
/// Beside its equations the curve has
///
///   bool goes_on()                                    whether there may be another try
///   void save()                                       the present point is the last one
///   bool correct(const Move& tangent, double length)  to the curve, from the end of a predicted step of this
///                                                     length, see correct_across(); linearised there or near
///   void refuse()                                     back to the last point
template <class Move>
struct ArclengthSteps {
  ArclengthLimits limits;
  double length = 0;   ///< of the next step
  Move tangent = {};   ///< of length one
  Move previous = {};  ///< the tangent at the point before
  double way = 0;      ///< from there; 0: there is none
  Move next = {};      ///< the tangent after a step that is not yet accepted
  double cosine = 1;   ///< of the angle by which the last step turned

  /// At a point where the curve was linearised; `sense` is the sign of its direction.
  template <class Curve>
  void begin(const Curve& curve, double first_length, double sense) {
    length = first_length;
    way = 0;
    find_next(curve, nullptr, sense);
    std::swap(tangent, next);
  }

  /// The same, onward from the present tangent, at a point that no step has reached.
  template <class Curve>
  void begin_anew(const Curve& curve) {
    way = 0;
    find_next(curve, &tangent, 0);
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
    move.add(tangent, half);
    move.add(previous, -half);
    return move;
  }
  template <class Curve>
  void find_next(const Curve& curve, const Move* before, double sense) {
    const TangentScale onward = tangent_scale(curve, before, sense);
    next = curve.direction;
    next.scale(onward.scale);
    cosine = onward.cosine;
  }
};

}  // namespace extremal
