#pragma once

#include <functional>
#include <span>
#include <vector>

/// \file Integration of ordinary differential equations by the method of Dormand and Prince of order 8.

namespace extremal {

/// Writes y' at (t, y); false where it cannot be evaluated: the step is then shortened.
using RightHandSide = std::function<bool(double t, std::span<const double> y, std::span<double> slope)>;

enum class Integrated { done, step_underflow, step_limit };

struct IntegrationOptions {
  double tolerance = 1e-12;  ///< error of a step relative to the largest component of a block
  int block = 0;             ///< components that share a unit stand in blocks of so many; 0: all in one
  int max_steps = 1000000;
};

class Dop853 {
 public:
  Dop853(RightHandSide right_hand_side, int size);

  /// Takes y from t to `end` (either direction); on failure both are where it stopped. Starts with the step
  /// length that the last call ended with.
  Integrated advance(double& t, std::span<double> y, double end, const IntegrationOptions& options);

  /// One step of length h from (t, y) into next(); false if a stage cannot be evaluated.
  bool step(double t, std::span<const double> y, double h);
  std::span<const double> next() const { return next_; }

  int steps() const { return steps_; }
  int rejected() const { return rejected_; }

 private:
  double error_norm(std::span<const double> y, double h, const IntegrationOptions& options) const;
  double first_step(double t, std::span<const double> y, double span, const IntegrationOptions& options);

  RightHandSide slope_;
  int size_, steps_ = 0, rejected_ = 0;
  double h_ = 0;
  std::vector<double> k_, stage_, next_;
};

}  // namespace extremal
