#pragma once

#include <Eigen/Dense>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "system/lagrangian.hpp"

/// \file The initial state of an orbit that closes better.

namespace extremal {

/// q and p at one time, 2n.
using PhasePoint = Eigen::VectorXd;

/// A motion by its points, row by row, in the order in which it is followed.
struct MotionPoints {
  std::vector<Extended> t;
  std::vector<Extended> y;  ///< (q, p), 2n for each t
};

/// Newton's method of shooting: the motion from a state at t = 0 and the one from where it has to arrive at
/// t = T, followed back, are to meet. Variations grow in an encounter by as much as it is close, and shrink
/// again: they are integrated in long double, between points of the motions, which are known better still.
class ClosingCorrection {
 public:
  /// For a system that ExtendedFlow suits. Neither motion may be empty. valid() is false where variations
  /// cannot be followed.
  ClosingCorrection(const Problem& problem, const MotionPoints& onwards, const MotionPoints& back,
                    const Deadline& deadline);

  bool valid() const { return inverse_.size() > 0; }
  /// The change of (q, p) at t = 0 that closes the orbit to first order if the motions end `apart`. The
  /// least one, in units of the largest |q| and |p| at the start: symmetries leave directions open.
  PhasePoint change(const PhasePoint& apart) const { return -unit_.cwiseProduct(inverse_ * apart); }
  /// Its size in these units.
  double size(const PhasePoint& change) const {
    return change.cwiseQuotient(unit_).lpNorm<Eigen::Infinity>();
  }

 private:
  PhasePoint unit_;
  Eigen::MatrixXd inverse_;
};

}  // namespace extremal
