#pragma once

#include <span>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file What integration forward in time can do: run from a state, and solve a problem with fixed ends by
/// single shooting.

namespace extremal {

/// Motion from an initial state.
struct Flight {
  bool complete = false;     ///< reached the last of the times
  double reached = 0;        ///< the time where it stopped
  std::vector<double> q, v;  ///< at each of the times reached, row by row: [k*n + a]
};

/// Integrates from (q, q') at time 0 through ascending `times` >= 0. Throws std::invalid_argument for a
/// singular constant mass, wrong sizes or times that do not ascend.
Flight fly(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
           std::span<const double> times, double tolerance = 1e-13);

struct ShootingOptions {
  double tolerance = 1e-9;  ///< error at the end, relative to the largest end value or distance
  int max_iterations = 50;
};

/// Pessimistic until proved otherwise.
struct Shot {
  Status status = Status::not_converged;
  std::string message = "nothing has been solved";
  std::vector<double> momentum_start, velocity_start;
  double miss = 0;  ///< largest |q(T) − wanted|
  int iterations = 0;
  int steps = 0;  ///< of the integrator, in all
};

/// Single shooting with the variational equations and a damped Newton iteration (natural monotonicity test),
/// from the initial velocity of the guess. Throws std::invalid_argument unless both ends and the duration are
/// fixed.
Shot shoot(const Problem& problem, const ShootingOptions& options = {});

}  // namespace extremal
