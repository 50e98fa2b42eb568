#pragma once

#include "system/lagrangian.hpp"

namespace extremal {

/// What a Lagrangian also is whose second derivatives are known with more digits than doubles have.
class ExtendedHessian {
 public:
  virtual ~ExtendedHessian() = default;

  /// The rows of Order::hessian at one point (n coordinates, n velocities, time).
  virtual void evaluate_hessian(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                                DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const = 0;
  virtual void evaluate_hessian(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                                PointScratch<Extended>& scratch) const = 0;
};

}  // namespace extremal
