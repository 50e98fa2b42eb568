#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "machine/deadline.hpp"

/// \file Integration of ordinary differential equations by the method of Dormand and Prince of order 8.

namespace extremal {

/// Writes y' at (t, y); false where it cannot be evaluated: the step is then shortened.
template <class T>
using RightHandSide = std::function<bool(T t, std::span<const T> y, std::span<T> slope)>;

enum class Integrated { done, step_underflow, step_limit, deadline };

struct IntegrationOptions {
  double tolerance = 1e-12;  ///< error of a step relative to the largest component of a block
  int block = 0;             ///< components that share a unit stand in blocks of so many; 0: all in one
  /// Blocks that are smaller than these, in turn, count as so large.
  std::array<double, 2> least = {0, 0};
  int controlled = 0;  ///< the first components, whose error sets the step; 0: all
  int max_steps = 1000000;
  Deadline deadline = {};
};

/// In double or long double.
template <class T>
class DormandPrince {
 public:
  DormandPrince(RightHandSide<T> right_hand_side, int size);

  /// Takes y from t to `end` (either direction); on failure both are where it stopped. Starts with the step
  /// length that the last call ended with.
  Integrated advance(T& t, std::span<T> y, T end, const IntegrationOptions& options);

  /// One accepted step towards `end`.
  Integrated accept_step(T& t, std::span<T> y, T end, const IntegrationOptions& options);

  /// Interpolation of order 7 in the last accepted step, of the first `components` of y, which must have a
  /// slope of their own. False where the right-hand side cannot be evaluated.
  bool prepare_interpolation(std::span<const T> y, int components);
  /// At the fraction theta of the step, as many components as y has.
  void interpolate(T theta, std::span<T> y) const;

  /// One step of length h from (t, y) into next(); false if a stage cannot be evaluated.
  bool step(T t, std::span<const T> y, T h);
  std::span<const T> next() const { return next_; }

  int steps() const { return steps_; }
  int rejected() const { return rejected_; }

 private:
  T error_norm(std::span<const T> y, T h, const IntegrationOptions& options) const;
  T first_step(T t, std::span<const T> y, T span, const IntegrationOptions& options);

  RightHandSide<T> slope_;
  int size_, steps_ = 0, rejected_ = 0;
  T h_ = 0;
  T last_t_ = 0, last_h_ = 0;  ///< of the last accepted step
  std::vector<T> k_, stage_, next_;
  std::vector<T> last_y_, shape_;  ///< where that step began; 7 coefficients for each component
};

using Dop853 = DormandPrince<double>;

}  // namespace extremal
