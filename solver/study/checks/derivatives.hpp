#pragma once

#include <string>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"

/// \file The derivatives of a Lagrangian against differences of its values, for people who doubt them.

namespace extremal {

/// The derivative that agrees worst, of those of one order.
struct WorstDerivative {
  std::string name;       ///< "∂L/∂x", "∂²L/∂x'∂y"
  double derivative = 0;  ///< as the tape gives it
  double difference = 0;  ///< of sixth order, of the values (first order) or the gradient (second)
  double error =
      0;  ///< |derivative − difference| beyond roundoff, over the largest of that order at the point
  double t = 0;
  std::vector<double> q, v;
};

struct DerivativeCheck {
  int points = 0;  ///< that were finite
  int columns =
      0;  ///< variables that differences were taken by: all, or where they are many a spread of them
  WorstDerivative gradient, hessian;
  bool agree() const { return points > 0 && gradient.error < 1e-6 && hessian.error < 1e-6; }
};

/// At points about the guess. Derivatives that the structure says vanish are checked to vanish. Of the terms
/// that are quadratic in the velocities only the rest of L is evaluated, and checked.
/// After the deadline differences by further variables are left out.
DerivativeCheck check_derivatives(const Problem& problem, const Deadline& deadline = {});

}  // namespace extremal
