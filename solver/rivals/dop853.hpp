#pragma once

#include <array>
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
  /// Blocks that are smaller than these, in turn, count as so large.
  std::array<double, 2> least = {0, 0};
  int controlled = 0;  ///< the first components, whose error sets the step; 0: all
  int max_steps = 1000000;
};

class Dop853 {
 public:
  Dop853(RightHandSide right_hand_side, int size);

  /// Takes y from t to `end` (either direction); on failure both are where it stopped. Starts with the step
  /// length that the last call ended with.
  Integrated advance(double& t, std::span<double> y, double end, const IntegrationOptions& options);

  /// One accepted step towards `end`.
  Integrated accept_step(double& t, std::span<double> y, double end, const IntegrationOptions& options);

  /// Interpolation of order 7 in the last accepted step, of the first `components` of y, which must have a
  /// slope of their own. False where the right-hand side cannot be evaluated.
  bool prepare_interpolation(std::span<const double> y, int components);
  /// At the fraction theta of the step.
  void interpolate(double theta, std::span<double> y) const;

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
  double last_t_ = 0, last_h_ = 0;  ///< of the last accepted step
  int interpolated_ = 0;
  std::vector<double> k_, stage_, next_;
  std::vector<double> last_y_, shape_;  ///< where that step began; 7 coefficients for each component
};

}  // namespace extremal
