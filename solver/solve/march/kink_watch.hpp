#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "solution/solution.hpp"
#include "solve/march/element_solver.hpp"
#include "system/kinks.hpp"

/// \file Where a march meets the kinks of L: elements end there. Gauss's rule has no point at the end of an
/// element, so that one that ends on the surface u = 0, or a little beyond, is that of a smooth L.

namespace extremal {

class KinkWatch {
 public:
  /// Null kinks: nothing is watched.
  KinkWatch(const StepTables& tables, const MotionState& start);

  bool active() const { return kinks_ != nullptr; }

  /// No element from the state needs to be longer than this: surfaces are met there, at the present rate.
  double expected(double h) const;

  struct Verdict {
    /// The length that ends on the surface, better than the one that was solved; absent where the element
    /// stays on one side, or ends there.
    std::optional<double> length;
  };
  /// Of the element x over h from the state. `precision`: of times.
  Verdict judge(const MotionState& state, std::span<const double> x, double h, double precision);
  /// The element just judged was taken. True if it ends on a surface.
  bool accept();

 private:
  struct Side {
    double value = 0, rate = 0;  ///< u and its derivative at the end of the last element
    bool on = false;             ///< the last element ended on the surface
  };
  double at(const KinkSurface& surface, const MotionState& state, std::span<const double> x, double h,
            double tau);

  const StepTables& tables_;
  const Kinks* kinks_;
  std::vector<Side> sides_, next_;
  double missed_ = INFINITY;  ///< by the last element that ended on a surface
  std::vector<double> value_, derivative_, q_, v_;
  Scratch scratch_;
};

/// Elements of a trajectory that begin and end on different sides of a surface.
int kinked_elements(const Lagrangian& lagrangian, const Trajectory& trajectory);

}  // namespace extremal
