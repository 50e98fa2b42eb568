#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solve/bordered/bordered_equations.hpp"

/// \file Newton's method for a path together with constants, multipliers and times.

namespace extremal {

struct BorderedReport {
  bool converged = false;
  std::string failure;  ///< why not
  int steps = 0;
  double correction = 1;  ///< the last, relative: of q by its range, of T by itself, of constants by theirs
};

/// Whether there may be no more steps, asked before each factorisation too.
using Spent = std::function<bool()>;

/// Damped by natural monotonicity (Deuflhard, Newton Methods for Nonlinear Problems, 3.3), until corrections
/// are roundoff. The state stays where it has got to. `on_step` is told each step's size and damping.
BorderedReport converge(BorderedEquations& equations, BorderedState& state, const Spent& spent,
                        const std::function<void(double step, double damping)>& on_step);

/// Directions in which solutions move to others, to first order: where the derivatives are singular.
struct Freedom {
  int count() const { return static_cast<int>(directions.cols()); }
  Eigen::MatrixXd directions;  ///< columns over all unknowns; the largest entry of each, in its unit, is 1
  std::vector<char> moves;     ///< whether they change a constant k
};
Freedom freedom_of(BorderedEquations& equations, BorderedState& state);

/// ν and η that balance the equations of the path best, in the sense of least squares.
void estimate_multipliers(BorderedEquations& equations, BorderedState& state, const Problem& problem);

}  // namespace extremal
