#pragma once

#include <span>
#include <string>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file What integration forward in time can do: run from a state, and solve a boundary problem by single or
/// multiple shooting.

namespace extremal {

/// Motion from an initial state.
struct Flight {
  bool complete = false;     ///< reached the last of the times
  double reached = 0;        ///< the time where it stopped
  std::vector<double> q, v;  ///< at each of the times reached, row by row: [k*n + a]
};

/// Integrates from (q, q') at time 0 through ascending `times` >= 0. Throws std::invalid_argument for a
/// singular constant mass, wrong sizes or times that do not ascend. For `copies` see Flow.
Flight fly(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
           std::span<const double> times, double tolerance = 1e-13, int copies = 1);

struct ShootingOptions {
  double tolerance = 1e-9;  ///< of the last correction of q, relative to the largest range or value
  int segments = 1;         ///< 1: single shooting
  int max_iterations = 50;
  Deadline deadline = {};
};

/// Pessimistic until proved otherwise.
struct Shot {
  Status status = Status::not_converged;
  std::string message = "nothing has been solved";
  std::vector<double> times;  ///< of the start of each segment, and T
  std::vector<double> q, v;   ///< at the start of each segment, row by row: [k*n + a]
  double correction = 0;      ///< the last one, relative as the tolerance
  int iterations = 0;
  int steps = 0;  ///< of the integrator, eight lanes at once, in all

  bool converged() const { return status == Status::converged; }
  double duration() const { return times.empty() ? 0 : times.back(); }
};

/// DOP853 with variational equations, many segments side by side, and a damped Newton iteration (natural
/// monotonicity test) from positions and velocities of the guess: far from the solution to a loose tolerance,
/// near it to the one wanted and with factors that are kept as long as they serve. Any ends; the duration may
/// be free. Throws std::invalid_argument for a singular constant mass or less than one segment.
Shot shoot(const Problem& problem, const ShootingOptions& options = {});

/// The motion found, at ascending times in [0, T]: each from the start of its segment.
Flight follow(const Lagrangian& lagrangian, const Shot& shot, std::span<const double> times,
              double tolerance = 1e-13, const Deadline& deadline = {}, int copies = 1);

}  // namespace extremal
