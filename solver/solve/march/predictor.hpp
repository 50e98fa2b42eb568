#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/flow.hpp"
#include "solution/solution.hpp"
#include "solve/march/element_solver.hpp"

/// \file The first guess of the next element.

namespace extremal {

/// Uniform motion with the velocity that the momentum has, for the first element: rest where L is quadratic
/// in velocities, for which Newton's method begins anywhere. Nearly rest where they are not found: dry
/// friction has no value at rest, and the first step goes to the side that the other forces push to.
class UniformMotion {
 public:
  /// `paired`: of two copies of the coordinates.
  UniformMotion(const StepTables& tables, bool paired);
  void predict(const MotionState& state, double h, std::span<double> x);

 private:
  const int degree_, copies_;
  std::optional<Flow> flow_;
  std::vector<double> q_, p_, v_;
};

/// Unknowns of equal elements continued by their backward differences: Σ_i ∇^i x, to the order that served
/// the last element best.
class Differences {
 public:
  explicit Differences(int size);
  /// Of the next element; at least one has been added.
  void predict(std::span<double> x) const;
  void add(std::span<const double> x);
  bool empty() const { return count_ == 0; }

 private:
  int size_, count_ = 0, order_ = 0;
  std::vector<double> table_;  ///< ∇^i x, i = 0 … count − 1
  std::vector<double> work_;
};

/// The polynomial of the last element continued, by its Legendre coefficients as far as their terms fall.
class PolynomialContinuation {
 public:
  explicit PolynomialContinuation(const StepTables& tables);
  /// The next element is `ratio` times as long as the last, x.
  void predict(std::span<const double> last, double ratio, std::span<double> x);
  /// The size of the last Legendre coefficients of an element, and what each is of the one before.
  struct Tail {
    double size = 0, fall = 0, extent = 0;
  };
  /// `magnitude`: the largest |q|, whose rounding coefficients are not told from.
  Tail tail(std::span<const double> x, double magnitude);

 private:
  void coefficients(std::span<const double> x);
  const StepTables& tables_;
  std::vector<double> coefficients_, values_, legendre_;
};

/// A trajectory, with slopes, read at the nodes of elements that come in order.
class TrajectoryReader {
 public:
  TrajectoryReader(const Trajectory& trajectory, const StepTables& tables);
  /// q relative to that at `time`, as the unknowns of an element from there on.
  void predict(double time, double h, std::span<double> x);

 private:
  void at(double time, std::span<double> q);
  const Trajectory& trajectory_;
  const StepTables& tables_;
  int element_ = 0;
  std::vector<double> start_, q_, v_;
  double value_[max_degree + 1];
};

}  // namespace extremal
