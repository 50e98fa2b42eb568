#pragma once

#include <Eigen/Dense>
#include <vector>

#include "problem/problem.hpp"

/// \file What the ends ask of a motion.

namespace extremal {

/// The boundary relation and the natural conditions are as many linear equations between the states y = (q,
/// p) at both ends as a state has entries. Those between entries of the start alone leave some of these free:
///   y(0) = base + free w,   w_k = y(0)_entry(k).
/// Those that remain, as many as entries of w, are met where `miss` is zero.
class MotionConditions {
 public:
  using Vector = Eigen::VectorXd;

  explicit MotionConditions(const Problem& problem);

  int unknowns() const { return static_cast<int>(entries_.size()); }
  int entry(int k) const { return entries_[k]; }
  Vector start(const Vector& w) const { return base_ + free_ * w; }
  Vector unknown(const Vector& start) const;
  Vector miss(const Vector& start, const Vector& end) const {
    return at_start_ * start + at_end_ * end - wanted_;
  }
  /// Of the miss, by those of the state.
  Vector miss_unit(const Vector& state) const { return at_end_.cwiseAbs() * state; }
  /// y(0) by w.
  const Eigen::MatrixXd& variations() const { return free_; }
  /// The miss by w, from the derivatives of y(T) by it.
  Eigen::MatrixXd derivatives(const Eigen::MatrixXd& end) const { return at_start_ * free_ + at_end_ * end; }

 private:
  std::vector<int> entries_;
  Vector base_, wanted_;
  Eigen::MatrixXd free_, at_start_, at_end_;
};

}  // namespace extremal
