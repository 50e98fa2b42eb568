#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "solve/march/dense_output.hpp"
#include "solve/march/march.hpp"

/// \file The elements of a march as they come.

namespace extremal {

/// Trajectory, action and extents of a motion that grows by an element at a time.
class MarchRecord {
 public:
  MarchRecord(const StepTables& tables, const InitialData& start, std::size_t expected, bool recovering);

  const MotionState& state() const { return state_; }
  /// The element that was solved; it ends at `time`.
  void add(const ElementSolver& solver, std::span<const double> x, double h, double time);
  bool finite() const { return std::isfinite(action_.high); }
  void add_finer(double action) { finer_action_.add(action); }
  void count(int steps) { march_.steps += steps; }
  bool full() const;

  /// Largest range of a coordinate, of a velocity and of a momentum so far.
  double range_q() const { return range_q_; }
  double range_v() const { return range_v_; }
  double range_p() const { return range_p_; }
  March& march() { return march_; }
  /// Orders by which the trajectory is better than the elements.
  int gain() const { return output_.gain(); }
  int elements() const { return march_.trajectory.elements(); }
  March finish(March::End end);

 private:
  void agree();

  const int n_;
  const bool paired_;
  DenseOutput output_;
  MotionState state_, before_;
  March march_;
  LongSum action_, finer_action_;
  double residual_ = 0, momentum_ = 0, range_q_ = 0, range_v_ = 0, range_p_ = 0;
  std::vector<double> low_, high_;  ///< of q, then of q', then of p
};

}  // namespace extremal
