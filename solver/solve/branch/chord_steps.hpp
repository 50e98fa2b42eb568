#pragma once

#include <cmath>

#include "solve/branch/branch.hpp"

/// \file Corrections of a step along a branch, with as few factorisations as they take.

namespace extremal {

/// A gradient costs a quarter of a factorisation: present factors, while the problem stays the same, serve
/// as long as they lead to the goal soon. For newton_loop().
class ChordSteps {
 public:
  /// For a step of `length` along `tangent`. Ends where the remainder is below `goal`; a correction below
  /// `enough` will do where more steps would be needed.
  ChordSteps(Branch& branch, const Move& tangent, double length, double goal, double enough)
      : branch_(branch), tangent_(tangent), length_(length), goal_(goal), enough_(enough) {}

  static constexpr int most_steps = 8;
  Factors factors(int) const { return anew_ ? Factors::anew : Factors::before; }
  Progress take(bool solved, int k);
  Progress exhausted() const { return before_ <= enough_ ? Progress::arrived : Progress::failed; }

  int factorisations() const { return factorisations_; }
  /// How far the corrections went along the tangent.
  double along() const { return along_; }
  /// Whether they failed where there is no problem.
  bool left_problem() const { return left_problem_; }
  /// Whether the last ones were roundoff, that equations which are nearly singular amplify.
  bool roundoff() const { return roundoff_; }

 private:
  Branch& branch_;
  const Move& tangent_;
  const double length_, goal_, enough_;
  bool anew_ = true;    ///< factors are of this path
  bool newton_ = true;  ///< and were of that before, where the last move began
  double before_ = INFINITY, way_before_ = INFINITY, way_of_newton_ = INFINITY, curvature_ = INFINITY;
  double along_ = 0;
  int factorisations_ = 0;
  bool left_problem_ = false, roundoff_ = false;
};

}  // namespace extremal
